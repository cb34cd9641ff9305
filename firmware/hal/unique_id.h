// The chip's unique number from the signature row (10 bytes: lot, wafer and position on it). The
// data sheet of the ATmega32U4 does not describe them. LUFA and QMK use them as the serial number,
// and the ATmega328PB's data sheet describes the same bytes.
#ifndef FIRMWARE_HAL_UNIQUE_ID_H
#define FIRMWARE_HAL_UNIQUE_ID_H

#include <avr/boot.h>
#include <stdint.h>

namespace firmware {

static const uint8_t kUniqueIdBytes = 10;

// Call before interrupts are enabled: the row must be read within three cycles of the request.
inline void read_unique_id(uint8_t* out) {
  const uint8_t kFirst = 0x0E;
  for (uint8_t i = 0; i < kUniqueIdBytes; ++i) out[i] = boot_signature_byte_get(kFirst + i);
}

}  // namespace firmware

#endif
