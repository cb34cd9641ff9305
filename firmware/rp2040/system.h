// Clocks, pins, time, the watchdog, the boot ROM's functions.
#ifndef FIRMWARE_RP2040_SYSTEM_H
#define FIRMWARE_RP2040_SYSTEM_H

#include <stdint.h>

#include "rp2040/registers.h"

namespace rp2040 {

// Starts clocks and pins: 125 MHz from the 12 MHz crystal, 48 MHz for USB, a microsecond timer.
// Takes peripherals out of reset and configures the pins of board.h.
void start_system();

inline uint32_t micros() {
  return reg(kTimerLow);
}

// Sleeps until at_us and serves interrupts meanwhile. Precondition: less than half an hour ahead.
void sleep_until(uint32_t at_us);
// The same, but any interrupt ends it. Returns at once if events, which interrupts count, has
// changed from `seen`, its value when the caller last looked for work.
void sleep_until_event(uint32_t at_us, const volatile uint8_t& events, uint8_t seen);
void wait_us(uint32_t duration_us);

inline void hold_interrupts() {
  asm volatile("cpsid i" ::: "memory");
}
inline void allow_interrupts() {
  asm volatile("cpsie i" ::: "memory");
}

// Compiler barrier between shared data and the index that publishes it. A single core executes in
// order, so only the compiler must not reorder.
inline void keep_order() {
  asm volatile("" ::: "memory");
}

// Resets peripherals to their power-on state.
void reset_peripherals(uint32_t peripherals);

// Waits at least this many cycles, 3 per iteration.
inline __attribute__((always_inline)) void wait_cycles(uint32_t cycles) {
  uint32_t rounds = cycles / 3;
  asm volatile("1: sub %0, #1\n bne 1b\n" : "+l"(rounds) : : "cc");
}

// The watchdog restarts a program that hangs.
constexpr uint32_t kWatchdogUs = 100'000;
void start_watchdog();
void feed_watchdog(uint32_t for_us = kWatchdogUs);
// Watchdog resets since power-on. The first call after a reset counts it.
uint32_t watchdog_resets();

// A function of the boot ROM by its two-letter code, which the ROM must have.
void* rom_function(char first, char second);

// Enters the USB boot loader, which appears as a drive. Does not return.
[[noreturn]] void enter_boot_loader();

void set_led(uint8_t brightness);
bool button_pressed();

}  // namespace rp2040

#endif
