// The two lines of the motors' bus, for core/soft_i2c.h. Each register change is one instruction,
// so that an interrupt cannot corrupt it.
#ifndef FIRMWARE_HAL_I2C_WIRES_H
#define FIRMWARE_HAL_I2C_WIRES_H

#include "hal/board.h"

namespace firmware {

struct I2cWires {
  static void clock_low() { pull<BOARD_I2C_CLOCK_BIT>(); }
  static void clock_free() { let_go<BOARD_I2C_CLOCK_BIT>(); }
  static void data_low() { pull<BOARD_I2C_DATA_BIT>(); }
  static void data_free() { let_go<BOARD_I2C_DATA_BIT>(); }
  static bool clock() { return (BOARD_I2C_PIN & _BV(BOARD_I2C_CLOCK_BIT)) != 0; }
  static bool data() { return (BOARD_I2C_PIN & _BV(BOARD_I2C_DATA_BIT)) != 0; }
  // 0.5 us including the surrounding instructions: the rise time with 4.7 kOhm and 100 pF.
  static void settle() { __builtin_avr_delay_cycles(5); }
  static void wait_high() { __builtin_avr_delay_cycles(6); }
  static void wait_low() { __builtin_avr_delay_cycles(11); }

 private:
  // This order never drives a line high.
  template <uint8_t BIT>
  static void pull() {
    BOARD_I2C_PORT &= static_cast<uint8_t>(~_BV(BIT));
    BOARD_I2C_DDR |= _BV(BIT);
  }
  template <uint8_t BIT>
  static void let_go() {
    BOARD_I2C_DDR &= static_cast<uint8_t>(~_BV(BIT));
    BOARD_I2C_PORT |= _BV(BIT);
  }
};

}  // namespace firmware

#endif
