// What the core asks of the board it runs on. The hal defines these for each micro-controller; on
// the host they do nothing (core/sampling_host.cpp), since a test samples and polls on one thread.
#ifndef FIRMWARE_CORE_SAMPLING_H
#define FIRMWARE_CORE_SAMPLING_H

#include <stdint.h>

namespace firmware {

// Keeps the sampling interrupt out, so that the polling side may change what both sides write.
void hold_sampling();
void resume_sampling();

// Pulls the lines of the set bits low and lets the others float. Data is driven before clock,
// because a request to send needs data low when the clock is let go. Called with sampling held.
void drive_lines(uint8_t clock_low, uint8_t data_low);

class SamplingHeld {
 public:
  SamplingHeld() { hold_sampling(); }
  ~SamplingHeld() { resume_sampling(); }
  SamplingHeld(const SamplingHeld&) = delete;
  SamplingHeld& operator=(const SamplingHeld&) = delete;
};

}  // namespace firmware

#endif
