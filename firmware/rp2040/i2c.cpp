#include "rp2040/i2c.h"

#include "rp2040/board.h"
#include "rp2040/system.h"

namespace rp2040 {

namespace {

constexpr uint32_t kCon = kI2c0, kTarget = kI2c0 + 0x04, kData = kI2c0 + 0x10,
                   kHighCount = kI2c0 + 0x1C, kLowCount = kI2c0 + 0x20, kMask = kI2c0 + 0x30,
                   kRaw = kI2c0 + 0x34, kClearAbort = kI2c0 + 0x54, kClearStop = kI2c0 + 0x60,
                   kEnable = kI2c0 + 0x6C, kSpike = kI2c0 + 0xA0;
constexpr uint32_t kAborted = bit(6), kStopped = bit(9);  // of kRaw
constexpr uint32_t kRead = bit(8), kStopAfter = bit(9);   // of kData
constexpr uint32_t kBitCycles = kSystemHz / 400'000;
constexpr uint32_t kTimeoutUs = 1000;  // a write takes 75 us

}  // namespace

void I2c::start() {
  reg(kEnable) = 0;
  reg(kCon) = 1 | 2 << 1 | bit(5) | bit(6);  // controller, fast mode, restart, no target
  reg(kHighCount) = kBitCycles * 2 / 5;
  reg(kLowCount) = kBitCycles * 3 / 5;
  reg(kSpike) = 6;  // 48 ns
  reg(kMask) = 0;
  reg(kNvicEnable) = bit(kIrqI2c0);
  busy_ = false;
  failed_ = false;
}

void I2c::aim(uint8_t address) {
  reg(kEnable) = 0;
  reg(kTarget) = address;
  reg(kEnable) = 1;
  uint32_t cleared = reg(kClearAbort);  // by reading
  cleared = reg(kClearStop);
  (void)cleared;
}

void I2c::begun() {
  reg(kMask) = kAborted | kStopped;
  began_us_ = micros();
  busy_ = true;
  failed_ = false;
}

void I2c::write(uint8_t address, const uint8_t* bytes, uint8_t size) {
  aim(address);
  for (uint8_t i = 0; i < size; ++i) {
    reg(kData) = bytes[i] | (i + 1 == size ? kStopAfter : 0);
  }
  begun();
}

void I2c::read(uint8_t address) {
  aim(address);
  reg(kData) = kRead | kStopAfter;
  begun();
}

uint8_t I2c::byte() {
  return static_cast<uint8_t>(reg(kData));
}

firmware::I2cBus::State I2c::state() {
  if (busy_) {
    const uint32_t raw = reg(kRaw);
    if ((raw & kAborted) != 0) {
      busy_ = false;
      failed_ = true;
    } else if ((raw & kStopped) != 0) {
      busy_ = false;
    } else if (micros() - began_us_ > kTimeoutUs) {
      reg(kEnable) = 0;  // somebody holds a line: let go of both
      busy_ = false;
      failed_ = true;
    }
  }
  return busy_ ? kBusy : failed_ ? kFailed : kIdle;
}

void I2c::on_interrupt() {
  reg(kMask) = 0;
}

}  // namespace rp2040
