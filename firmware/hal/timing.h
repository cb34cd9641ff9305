// The sampling interrupt and the clock of the polling loop. The application defines the interrupt
// in one line, so that the address of the lines is a constant. Access through a pointer would take
// half as long again.
//   ISR(TIMER1_COMPA_vect) { firmware::sample_lines(g_mice.lines()); }
#ifndef FIRMWARE_HAL_TIMING_H
#define FIRMWARE_HAL_TIMING_H

#include <stdint.h>

#include "core/ps2_lines.h"
#include "hal/board.h"

namespace firmware {

// Lets all lines float and starts to sample them every kSampleUs.
void start_sampling();

FIRMWARE_INLINE void sample_lines(Ps2Lines& lines) {
  const uint8_t clock = BOARD_CLOCK_PIN;
  const uint8_t data = BOARD_DATA_PIN;
  lines.count_sample();
  const uint8_t clock_again = BOARD_CLOCK_PIN;
  lines.sample(clock, data, clock_again, [](uint8_t low) { BOARD_DATA_DDR = low; });
}

// Microseconds since start_sampling(), wraps. Call from the polling loop only, at least every 30
// ms.
uint32_t micros();

// Sleeps until the next interrupt, at most kSampleUs.
void sleep_until_sample();

}  // namespace firmware

#endif
