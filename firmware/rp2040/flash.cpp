#include "rp2040/flash.h"

#include "rp2040/system.h"

namespace rp2040 {

namespace {

constexpr uint32_t kSettingsOffset = (2u << 20) - 4096;  // last sector of a Pico's 2 MiB
constexpr uint32_t kSectorBytes = 4096, kPageBytes = 256;
constexpr uint8_t kReadUniqueId = 0x4B, kSectorErase = 0x20;
constexpr uint32_t kUncached = 0x03000000;  // offset of the flash alias that bypasses the cache

typedef void (*Simple)();
typedef void (*Erase)(uint32_t offset, uint32_t count, uint32_t block, uint8_t command);
typedef void (*Program)(uint32_t offset, const uint8_t* bytes, uint32_t count);

void call(char first, char second) {
  reinterpret_cast<Simple>(rom_function(first, second))();
}

// Between these two calls the flash accepts commands and cannot be read as memory.
void enter_commands() {
  call('I', 'F');
  call('E', 'X');
}
void leave_commands() {
  call('F', 'C');
  call('C', 'X');
}

// Controls the chip select by software: the SSI would release it whenever the processor is late.
void select_flash(bool selected) {
  constexpr uint32_t kOutputLow = 2 << 8, kOutputHigh = 3 << 8;
  reg(kQspiSelectCtrl) = selected ? kOutputLow : kOutputHigh;
}

uint8_t exchange(uint8_t value) {
  constexpr uint32_t kReceived = bit(3);
  reg(kSsiData) = value;
  while ((reg(kSsiStatus) & kReceived) == 0) {
  }
  return static_cast<uint8_t>(reg(kSsiData));
}

}  // namespace

void read_unique_id(uint8_t* out) {
  enter_commands();
  reg(kSsiEnable) = 0;
  reg(kSsiBaud) = 6;
  reg(kSsiCtrlr0) = 7 << 16;  // frames of 8 bits, transmit and receive
  reg(kSsiSlave) = 1;
  reg(kSsiEnable) = 1;
  select_flash(true);
  exchange(kReadUniqueId);
  for (uint8_t i = 0; i < 4; ++i) exchange(0);
  for (uint8_t i = 0; i < kUniqueIdBytes; ++i) out[i] = exchange(0);
  select_flash(false);
  reg(kQspiSelectCtrl) = 0;  // back to the SSI
  leave_commands();
}

bool load_settings(wire::DeviceSettings& settings) {
  return firmware::decode_kept(
      reinterpret_cast<const uint8_t*>(kFlash + kUncached + kSettingsOffset), settings);
}

void save_settings(const wire::DeviceSettings& settings) {
  uint8_t page[kPageBytes];
  for (uint8_t& byte : page) byte = 0xFF;
  firmware::encode_kept(settings, page);
  const Erase erase = reinterpret_cast<Erase>(rom_function('R', 'E'));
  const Program program = reinterpret_cast<Program>(rom_function('R', 'P'));
  feed_watchdog(2'000'000);
  hold_interrupts();
  enter_commands();
  erase(kSettingsOffset, kSectorBytes, kSectorBytes, kSectorErase);
  program(kSettingsOffset, page, kPageBytes);
  leave_commands();
  allow_interrupts();
  feed_watchdog();
}

}  // namespace rp2040
