#include "hal/outputs.h"

#include "hal/board.h"
#include "hal/i2c_wires.h"

namespace firmware {

namespace {

// 8-bit PWM at 16 MHz / 64: 977 Hz. To turn the LED off, the pin must be disconnected from the
// timer, whose shortest pulse is not zero.
#if defined(__AVR_ATmega32U4__)
void start_led_timer() {
  TC4H = 0;
  OCR4C = 255;
  TCCR4B = _BV(CS42) | _BV(CS41) | _BV(CS40);
}
void set_led_timer(uint8_t width) {
  TC4H = 0;
  OCR4A = width;
  TCCR4A = width == 0 ? 0 : _BV(COM4A1) | _BV(PWM4A);
}
#else
void start_led_timer() {
  TCCR0B = _BV(CS01) | _BV(CS00);
}
void set_led_timer(uint8_t width) {
  OCR0A = width;
  TCCR0A = static_cast<uint8_t>(_BV(WGM01) | _BV(WGM00) | (width == 0 ? 0 : _BV(COM0A1)));
}
#endif

}  // namespace

void start_outputs() {
  enable_motors(false);
  BOARD_MOTORS_DDR |= _BV(BOARD_MOTORS_BIT);
  I2cWires::clock_free();
  I2cWires::data_free();
  start_led_timer();
  set_led(0);
  BOARD_LED_DDR |= _BV(BOARD_LED_BIT);
}

void enable_motors(bool enabled) {
  if (enabled) {
    BOARD_MOTORS_PORT |= _BV(BOARD_MOTORS_BIT);
  } else {
    BOARD_MOTORS_PORT &= static_cast<uint8_t>(~_BV(BOARD_MOTORS_BIT));
  }
}

void set_led(uint8_t brightness) {
  const uint16_t square = static_cast<uint16_t>(brightness) * brightness;
  set_led_timer(static_cast<uint8_t>((square + 254u) / 255u));
}

}  // namespace firmware
