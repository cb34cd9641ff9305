#include "hal/watchdog.h"

#include <avr/interrupt.h>

#include "hal/board.h"

namespace firmware {

namespace {

// Some boot loaders hide the cause of a reset. So the watchdog first interrupts, before its reset,
// and sets a flag in memory that is not cleared at start.
const uint16_t kMark = 0x5744;
__attribute__((section(".noinit"))) volatile uint16_t g_mark;

}  // namespace

bool stop_watchdog() {
  const bool has_reset = g_mark == kMark || (MCUSR & _BV(WDRF)) != 0;
  g_mark = 0;
  MCUSR = 0;  // otherwise the watchdog cannot be stopped
  wdt_disable();
  return has_reset;
}

void start_watchdog() {
  cli();
  wdt_reset();
  // 64 ms to its interrupt, another 64 ms to its reset. The second write must follow within four
  // cycles.
  WDTCSR = _BV(WDCE) | _BV(WDE);
  WDTCSR = _BV(WDIE) | _BV(WDE) | _BV(WDP1);
  sei();
}

}  // namespace firmware

ISR(WDT_vect) {
  firmware::g_mark = firmware::kMark;
}
