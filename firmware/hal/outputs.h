// The enable line of the motors' drivers, and the LED.
#ifndef FIRMWARE_HAL_OUTPUTS_H
#define FIRMWARE_HAL_OUTPUTS_H

#include <stdint.h>

namespace firmware {

// Initial state: motors disabled, LED off, the motors' bus idle.
void start_outputs();
void enable_motors(bool enabled);
// 0: off. Corrects for the eye, which perceives the square root: equal steps look equal.
void set_led(uint8_t brightness);

}  // namespace firmware

#endif
