// Clocks, pins, time, the watchdog, the boot ROM's functions.
#ifndef FIRMWARE_RP2040_SYSTEM_H
#define FIRMWARE_RP2040_SYSTEM_H

#include <stdint.h>

#include "rp2040/registers.h"

namespace rp2040 {

// 125 MHz from the 12 MHz crystal, 48 MHz for USB, a microsecond timer; peripherals out of reset,
// pins as board.h has them.
void start_system();

inline uint32_t micros() {
  return reg(kTimerLow);
}

// Sleeps until then; interrupts are served meanwhile. Precondition: less than half an hour ahead.
void sleep_until(uint32_t at_us);
// The same, but any interrupt ends it. Does not sleep at all if events, which interrupts count, is
// no longer what it was when the caller last looked for work.
void sleep_until_event(uint32_t at_us, const volatile uint8_t& events, uint8_t seen);
void wait_us(uint32_t duration_us);

inline void hold_interrupts() {
  asm volatile("cpsid i" ::: "memory");
}
inline void allow_interrupts() {
  asm volatile("cpsie i" ::: "memory");
}

// What an interrupt and the polling loop hand each other in memory is there before the index that
// says so: one core does all in its order, only the compiler must not change it.
inline void keep_order() {
  asm volatile("" ::: "memory");
}

// Back to the state after power-on.
void reset_peripherals(uint32_t peripherals);

// At least so many: 3 cycles a round.
inline __attribute__((always_inline)) void wait_cycles(uint32_t cycles) {
  uint32_t rounds = cycles / 3;
  asm volatile("1: sub %0, #1\n bne 1b\n" : "+l"(rounds) : : "cc");
}

// A program that is stuck begins anew.
constexpr uint32_t kWatchdogUs = 100'000;
void start_watchdog();
void feed_watchdog(uint32_t for_us = kWatchdogUs);
// The watchdog's work, since power came; the first call after a reset counts it.
uint32_t watchdog_resets();

// A function of the boot ROM by its two letters; the ROM has those that are asked for here.
void* rom_function(char first, char second);

// Into the boot loader that shows itself as a drive. Does not return.
[[noreturn]] void enter_boot_loader();

void set_led(uint8_t brightness);
bool button_pressed();

}  // namespace rp2040

#endif
