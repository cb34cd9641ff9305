// The watchdog restarts a program that hangs for 128 ms.
#ifndef FIRMWARE_HAL_WATCHDOG_H
#define FIRMWARE_HAL_WATCHDOG_H

#include <avr/wdt.h>

namespace firmware {

// Call first at start: after a watchdog reset the watchdog still runs, for 16 ms. True: the
// watchdog caused this reset.
bool stop_watchdog();
void start_watchdog();
inline void feed_watchdog() {
  wdt_reset();
}

}  // namespace firmware

#endif
