// From the second-stage boot loader to main(): copies the program to RAM, clears its variables and
// runs its constructors. The vector table is at the start of RAM.
#include "rp2040/registers.h"

extern "C" {

extern uint32_t program_begin, program_end, program_in_flash, bss_begin, bss_end;
typedef void (*Constructor)();
extern Constructor init_array_begin, init_array_end;

int main();
void timer0_interrupt();
void timer1_interrupt();
void usb_interrupt();
void i2c0_interrupt();

// The only code that runs from flash. It calls nothing: the compiler must not insert a call of
// memcpy before memcpy is in RAM.
__attribute__((section(".copy_program"), noreturn, used,
               optimize("no-tree-loop-distribute-patterns"))) void
copy_program() {
  const uint32_t* from = &program_in_flash;
  for (uint32_t* to = &program_begin; to != &program_end; ++to, ++from) *to = *from;
  for (uint32_t* to = &bss_begin; to != &bss_end; ++to) *to = 0;
  asm volatile("" ::: "memory");
  rp2040::reg(rp2040::kVectorTable) = reinterpret_cast<uint32_t>(&program_begin);
  for (Constructor* make = &init_array_begin; make != &init_array_end; ++make) (*make)();
  main();
  for (;;) {
  }
}

// Handles faults and unexpected interrupts: waits for the watchdog's reset.
void unexpected() {
  for (;;) {
  }
}

void* memcpy(void* to, const void* from, unsigned size) {
  for (unsigned i = 0; i < size; ++i) {
    static_cast<volatile uint8_t*>(to)[i] = static_cast<const uint8_t*>(from)[i];
  }
  return to;
}
void* memset(void* to, int value, unsigned size) {
  for (unsigned i = 0; i < size; ++i) {
    static_cast<volatile uint8_t*>(to)[i] = static_cast<uint8_t>(value);
  }
  return to;
}

}  // extern "C"

namespace {

typedef void (*Handler)();

__attribute__((section(".vectors"), used, aligned(256))) const Handler kVectors[16 + 26] = {
    nullptr,    unexpected, unexpected, unexpected,     unexpected,       unexpected,
    unexpected, unexpected, unexpected, unexpected,     unexpected,       unexpected,
    unexpected, unexpected, unexpected, unexpected,     timer0_interrupt, timer1_interrupt,
    unexpected, unexpected, unexpected, usb_interrupt,  unexpected,       unexpected,
    unexpected, unexpected, unexpected, unexpected,     unexpected,       unexpected,
    unexpected, unexpected, unexpected, unexpected,     unexpected,       unexpected,
    unexpected, unexpected, unexpected, i2c0_interrupt, unexpected,       unexpected};

}  // namespace
