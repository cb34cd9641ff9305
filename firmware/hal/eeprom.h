// The EEPROM as the memory of core/settings_store.h.
#ifndef FIRMWARE_HAL_EEPROM_H
#define FIRMWARE_HAL_EEPROM_H

#include <stdint.h>

#include "hal/board.h"

namespace firmware {

struct Eeprom {
  static bool ready() { return (EECR & _BV(EEPE)) == 0; }
  static uint8_t read(uint8_t at) {
    EEAR = kFirst + at;
    EECR |= _BV(EERE);
    return EEDR;
  }
  // Takes 3.4 ms, of which the processor waits two cycles.
  static void write(uint8_t at, uint8_t value);

 private:
  // Not the first bytes: at undervoltage, a stray write may go to the address register's idle
  // value.
  static const uint16_t kFirst = 16;
};

}  // namespace firmware

#endif
