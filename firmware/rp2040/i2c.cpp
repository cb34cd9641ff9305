#include "rp2040/i2c.h"

#include "rp2040/board.h"
#include "rp2040/system.h"

namespace rp2040 {

namespace {

constexpr uint32_t kCon = kI2c0, kTarget = kI2c0 + 0x04, kData = kI2c0 + 0x10,
                   kHighCount = kI2c0 + 0x1C, kLowCount = kI2c0 + 0x20, kMask = kI2c0 + 0x30,
                   kRaw = kI2c0 + 0x34, kClearAbort = kI2c0 + 0x54, kClearStop = kI2c0 + 0x60,
                   kEnable = kI2c0 + 0x6C, kDataHold = kI2c0 + 0x7C, kEnableStatus = kI2c0 + 0x9C,
                   kSpike = kI2c0 + 0xA0;
constexpr uint32_t kAborted = bit(6), kStopped = bit(9);  // in kRaw
constexpr uint32_t kRead = bit(8), kStopAfter = bit(9);   // in kData
constexpr uint32_t kBitCycles = kSystemHz / 400'000;
constexpr uint32_t kHoldCycles =
    kSystemHz / 10'000 * 3 / 1000 + 1;  // 300 ns after the clock's falling edge
constexpr uint32_t kTimeoutUs = 1000;   // a write takes 75 us
// Disabling first completes the current byte (datasheet 4.3.10.3): 25 us at 400 kHz.
constexpr uint32_t kDisableUs = 30;
constexpr uint8_t kFreeingClocks = 9;

bool is_high(unsigned pin) {
  return (reg(kGpioIn) & bit(pin)) != 0;
}
// Open drain by software: the output is 0, either enabled or not.
void pull_low(unsigned pin) {
  reg(kGpioOeSet) = bit(pin);
  wait_cycles(kBitCycles / 2);
}
void let_go(unsigned pin) {
  reg(kGpioOeClear) = bit(pin);
  wait_cycles(kBitCycles / 2);
}
void give_pins_to(uint32_t function) {
  constexpr unsigned kPins[] = {kI2cData, kI2cClock};
  for (const unsigned pin : kPins) {
    reg(kGpioOeClear) = bit(pin);
    reg(kGpioOutClear) = bit(pin);
    reg(pin_ctrl(pin)) = function;
  }
}

}  // namespace

void I2c::start() {
  set_up();
  reg(kNvicEnable) = bit(kIrqI2c0);
}

void I2c::set_up() {
  reset_peripherals(kResetI2c0);
  // Controller mode, fast mode, restart enabled, target mode disabled.
  reg(kCon) = 1 | 2 << 1 | bit(5) | bit(6);
  reg(kHighCount) = kBitCycles * 2 / 5;
  reg(kLowCount) = kBitCycles * 3 / 5;
  reg(kSpike) = 6;  // 48 ns
  reg(kDataHold) = kHoldCycles;
  reg(kMask) = 0;
}

// Writes to its registers while it is enabled are lost.
void I2c::disable() {
  reg(kEnable) = 0;
  const uint32_t began_us = micros();
  while ((reg(kEnableStatus) & 1) != 0) {
    if (micros() - began_us <= kDisableUs) continue;
    set_up();
    return;
  }
}

void I2c::write(uint8_t address, const uint8_t* bytes, uint8_t size) {
  for (uint8_t i = 0; i < size; ++i) bytes_[i] = bytes[i];
  begin(address, size);
}

void I2c::read(uint8_t address) {
  begin(address, 0);
}

void I2c::begin(uint8_t address, uint8_t size) {
  address_ = address;
  size_ = size;
  failed_ = false;
  if (is_high(kI2cData)) {
    begin_transfer();
    return;
  }
  disable();
  give_pins_to(kFunctionSio);
  clocks_ = kFreeingClocks;
  work_ = kFreeing;
}

void I2c::begin_transfer() {
  disable();
  reg(kTarget) = address_;
  reg(kEnable) = 1;
  uint32_t cleared = reg(kClearAbort);  // cleared by reading
  cleared = reg(kClearStop);
  (void)cleared;
  if (size_ == 0) reg(kData) = kRead | kStopAfter;
  for (uint8_t i = 0; i < size_; ++i) {
    reg(kData) = bytes_[i] | (i + 1 == size_ ? kStopAfter : 0);
  }
  reg(kMask) = kAborted | kStopped;
  began_us_ = micros();
  work_ = kTransferring;
}

void I2c::end(bool good) {
  work_ = kNone;
  failed_ = !good;
}

void I2c::watch_transfer() {
  const uint32_t raw = reg(kRaw);
  if ((raw & kAborted) != 0) {
    end(false);
  } else if ((raw & kStopped) != 0) {
    end(true);
  } else if (micros() - began_us_ > kTimeoutUs) {
    set_up();
    end(false);
  }
}

void I2c::give_clock() {
  pull_low(kI2cClock);
  let_go(kI2cClock);
  if (!is_high(kI2cData) && is_high(kI2cClock) && --clocks_ != 0) return;
  pull_low(kI2cClock);  // STOP
  pull_low(kI2cData);
  let_go(kI2cClock);
  let_go(kI2cData);
  const bool free = is_high(kI2cData) && is_high(kI2cClock);
  give_pins_to(kFunctionI2c);
  if (free) {
    begin_transfer();
  } else {
    end(false);
  }
}

uint8_t I2c::byte() {
  return static_cast<uint8_t>(reg(kData));
}

firmware::I2cBus::State I2c::state() {
  if (work_ == kTransferring) watch_transfer();
  if (work_ == kFreeing) give_clock();
  return work_ != kNone ? kBusy : failed_ ? kFailed : kIdle;
}

void I2c::on_interrupt() {
  reg(kMask) = 0;
}

}  // namespace rp2040
