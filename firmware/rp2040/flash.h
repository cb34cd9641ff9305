// The flash beside the program: its chip's number, and the sector with the settings.
#ifndef FIRMWARE_RP2040_FLASH_H
#define FIRMWARE_RP2040_FLASH_H

#include <stdint.h>

#include "core/settings.h"

namespace rp2040 {

static constexpr uint8_t kUniqueIdBytes = 8;

// The 64 bits that no other flash chip of this kind has. Precondition: nothing is read from flash
// meanwhile, so no interrupt either.
void read_unique_id(uint8_t* out);

// Those that were saved; false, and settings untouched, if there are none that hold.
bool load_settings(wire::DeviceSettings& settings);
// Up to half a second without interrupts.
void save_settings(const wire::DeviceSettings& settings);

}  // namespace rp2040

#endif
