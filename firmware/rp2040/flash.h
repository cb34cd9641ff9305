// The flash apart from the program: its chip's number, and the sector with the settings.
#ifndef FIRMWARE_RP2040_FLASH_H
#define FIRMWARE_RP2040_FLASH_H

#include <stdint.h>

#include "core/settings.h"

namespace rp2040 {

static constexpr uint8_t kUniqueIdBytes = 8;

// Reads the flash chip's unique 64-bit number. Precondition: nothing reads flash meanwhile, so
// interrupts must be off too.
void read_unique_id(uint8_t* out);

// Loads the saved settings. False, with settings unchanged, if none are valid.
bool load_settings(wire::DeviceSettings& settings);
// Takes up to half a second with interrupts off.
void save_settings(const wire::DeviceSettings& settings);

}  // namespace rp2040

#endif
