#include "hal/eeprom.h"

#include <avr/interrupt.h>

namespace firmware {

void Eeprom::write(uint8_t at, uint8_t value) {
  EEAR = kFirst + at;
  EEDR = value;
  // The second write must follow within four cycles.
  cli();
  EECR |= _BV(EEMPE);
  EECR |= _BV(EEPE);
  sei();
}

}  // namespace firmware
