// The second-stage boot loader. The boot ROM copies the first 256 bytes of flash to RAM, checks the
// CRC in the last four (written by make_uf2.py) and jumps to them. This stage sets the flash to
// read command 03h, which every SPI flash supports, and enters the program. Its speed does not
// matter: the program runs from RAM (startup.cpp).
#include "rp2040/registers.h"

namespace {

constexpr uint32_t kProgramVectors = rp2040::kFlash + 0x100;

}  // namespace

extern "C" __attribute__((section(".boot2"), noreturn, used)) void second_stage() {
  using namespace rp2040;
  reg(kSsiEnable) = 0;
  reg(kSsiBaud) = 4;  // divides the ring oscillator's 6.5 MHz now, 125 MHz later: 31 MHz
  // Frames of 32 bits, one line, "EEPROM read": sends instruction and address, then reads data.
  reg(kSsiCtrlr0) = 31 << 16 | 3 << 8;
  reg(kSsiCtrlr1) = 0;  // one frame per access
  // Instruction 03h of 8 bits, address of 24 bits.
  reg(kSsiSpiCtrlr0) = 0x03u << 24 | 2 << 8 | 6 << 2;
  reg(kSsiEnable) = 1;
  asm volatile(
      "ldr r1, [%0]\n"
      "ldr r2, [%0, #4]\n"
      "msr msp, r1\n"
      "bx r2\n"
      :
      : "r"(kProgramVectors)
      : "r1", "r2");
  __builtin_unreachable();
}
