// The line that enables the motors' drivers, and the LED.
#ifndef FIRMWARE_HAL_OUTPUTS_H
#define FIRMWARE_HAL_OUTPUTS_H

#include <stdint.h>

namespace firmware {

// Motors disabled, LED dark, the motors' bus at rest.
void start_outputs();
void enable_motors(bool enabled);
// 0: dark. The eye sees the root: even steps of brightness are even to it.
void set_led(uint8_t brightness);

}  // namespace firmware

#endif
