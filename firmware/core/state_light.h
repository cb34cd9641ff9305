// LED patterns for the controller's state; docs/wiring.md has the table for users.
#ifndef FIRMWARE_CORE_STATE_LIGHT_H
#define FIRMWARE_CORE_STATE_LIGHT_H

#include <stdint.h>

namespace firmware {

static const uint8_t kLightTickMs = 100;
static const uint8_t kLightTicks = 10;  // length of a pattern

// Bit i: the LED is on in tick i. Steady: no fault. Five flashes: no host. One: a host, but no
// sensor. Nine ticks: some sensors missing. After a watchdog reset, each pattern has two gaps.
inline uint16_t light_pattern(bool host, uint8_t present, bool watchdog_has_reset) {
  const uint16_t pattern = !host ? 0x155 : present == 0 ? 0x001 : present == 0xFF ? 0x3FF : 0x1FF;
  return watchdog_has_reset ? static_cast<uint16_t>(pattern & ~0x088) : pattern;
}

}  // namespace firmware

#endif
