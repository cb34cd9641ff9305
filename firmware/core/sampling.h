// What the core needs from its board. The hal defines these functions for each micro-controller. On
// the PC they do nothing (core/sampling_host.cpp), since a test samples and polls on one thread.
#ifndef FIRMWARE_CORE_SAMPLING_H
#define FIRMWARE_CORE_SAMPLING_H

#include <stdint.h>

namespace firmware {

// Blocks the sampling interrupt, so that the polling side may change variables that both write.
void hold_sampling();
void resume_sampling();

// Pulls the lines of the set bits low and lets the others float. Drives data before clock, because
// a request to send needs data low when the clock is released. Precondition: sampling is held.
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
