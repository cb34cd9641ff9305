// Pin assignment of a Raspberry Pi Pico; docs/wiring.md has the same table for assembly.
#ifndef FIRMWARE_RP2040_BOARD_H
#define FIRMWARE_RP2040_BOARD_H

#include <stdint.h>

namespace rp2040 {

// Rod i: data line from its sensor, and its select line. For a PS/2 mouse: data and clock.
constexpr unsigned kFirstData = 0, kFirstSelect = 8;
constexpr unsigned kRodPins = 8;
constexpr unsigned kMotorsEnable = 17, kSensorClock = 18, kSensorData = 19, kI2cData = 20,
                   kI2cClock = 21, kButton = 22, kLed = 25;

constexpr uint32_t kSystemHz = 125'000'000;

}  // namespace rp2040

#endif
