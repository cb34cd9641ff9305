#include "hal/timing.h"

#include <avr/interrupt.h>
#include <avr/power.h>
#include <avr/sleep.h>

namespace firmware {

namespace {

uint32_t g_micros;
uint16_t g_last_half_us;

}  // namespace

// The polling loop never runs with interrupts off, so there is no earlier state to restore.
void hold_sampling() {
  cli();
}
void resume_sampling() {
  sei();
}

void drive_lines(uint8_t clock_low, uint8_t data_low) {
  BOARD_DATA_DDR = data_low;
  BOARD_CLOCK_DDR = clock_low;
}

void start_sampling() {
  // Fuses and boot loaders leave different clocks behind: a Teensy 2.0 starts at 2 MHz.
  clock_prescale_set(clock_div_1);

  BOARD_CLOCK_PORT = 0;
  BOARD_DATA_PORT = 0;
  drive_lines(0, 0);

  TCCR3A = 0;
  TCCR3B = _BV(CS31);  // free running, 0.5 us per count
  TCCR1A = 0;
  OCR1A = F_CPU / 1000000UL * kSampleUs - 1;
  TCCR1B = _BV(WGM12) | _BV(CS10);
  TIMSK1 = _BV(OCIE1A);
  set_sleep_mode(SLEEP_MODE_IDLE);
  sei();
}

uint32_t micros() {
  const uint16_t passed = static_cast<uint16_t>(TCNT3 - g_last_half_us);
  g_micros += passed >> 1;
  g_last_half_us = static_cast<uint16_t>(g_last_half_us + (passed & ~1u));
  return g_micros;
}

void sleep_until_sample() {
  sleep_mode();
}

}  // namespace firmware
