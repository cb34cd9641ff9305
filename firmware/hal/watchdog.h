// A program that is stuck begins again after 128 ms.
#ifndef FIRMWARE_HAL_WATCHDOG_H
#define FIRMWARE_HAL_WATCHDOG_H

#include <avr/wdt.h>

namespace firmware {

// First of all at the start, since after its reset the watchdog still runs, for 16 ms. True: it was
// the watchdog that has reset us.
bool stop_watchdog();
void start_watchdog();
inline void feed_watchdog() {
  wdt_reset();
}

}  // namespace firmware

#endif
