#include "core/haptics.h"

namespace firmware {

namespace {

struct Write {
  uint8_t address, value;
};
const uint8_t kPlaybackRegister = 0x02;
// Leave standby; open loop, unsigned playback data; amplitude 0; real-time playback.
const Write kSetUp[] = {{0x01, 0x00}, {0x1D, 0xA8}, {kPlaybackRegister, 0}, {0x01, 0x05}};
const uint8_t kSetUpWrites = sizeof kSetUp / sizeof kSetUp[0];

}  // namespace

void Haptics::pulse(uint8_t rod, uint8_t amplitude, uint16_t duration_ms, uint32_t now_ms) {
  poll(now_ms);  // so that the elapsed time does not count for this pulse
  if (!allowed_ || !safe_ || rod >= kMotors || (present_ & 1u << rod) == 0) return;
  Motor& motor = motors_[rod];
  if (motor.credit < amplitude) return;
  want(rod, amplitude);
  motor.left_ms = duration_ms < wire::kMaxPulseMs ? duration_ms : wire::kMaxPulseMs;
  stirred_ = static_cast<uint8_t>(stirred_ | 1u << rod);
  poll(now_ms);
}

void Haptics::all_off() {
  for (uint8_t rod = 0; rod < kMotors; ++rod) want(rod, 0);
}

void Haptics::want(uint8_t rod, uint8_t amplitude) {
  motors_[rod].wanted = amplitude;
  sent(rod, motors_[rod].sent);
}

void Haptics::sent(uint8_t rod, uint8_t amplitude) {
  motors_[rod].sent = amplitude;
  const uint8_t bit = static_cast<uint8_t>(1u << rod);
  due_ = static_cast<uint8_t>(motors_[rod].wanted == amplitude ? due_ & ~bit : due_ | bit);
}

void Haptics::allow(bool allowed) {
  allowed_ = allowed;
  if (!allowed) all_off();
}

void Haptics::made_safe() {
  for (Motor& motor : motors_) {
    motor.wanted = 0;
    motor.sent = 0;
  }
  due_ = 0;
  present_ = 0;
  safe_ = true;
}

void Haptics::pass_ms() {
  uint8_t bit = 1;
  for (uint8_t rod = 0; (stirred_ & ~(bit - 1u)) != 0;
       ++rod, bit = static_cast<uint8_t>(bit << 1)) {
    if ((stirred_ & bit) == 0) continue;
    Motor& motor = motors_[rod];
    motor.credit = static_cast<uint16_t>(motor.credit + kCreditPerMs);
    if (motor.wanted == 0) {
      if (motor.credit < kMaxCredit) continue;
      motor.credit = kMaxCredit;
      stirred_ = static_cast<uint8_t>(stirred_ & ~bit);
      continue;
    }
    if (motor.credit > kMaxCredit) motor.credit = kMaxCredit;
    motor.credit = static_cast<uint16_t>(motor.credit - motor.wanted);
    if (--motor.left_ms == 0 || motor.credit < motor.wanted) want(rod, 0);
  }
}

void Haptics::pass_time(uint32_t now_ms) {
  if (!begun_) now_ms_ = now_ms;
  begun_ = true;
  for (; now_ms_ != now_ms; ++now_ms_) pass_ms();
}

void Haptics::poll(uint32_t now_ms) {
  if (now_ms_ != now_ms || !begun_) pass_time(now_ms);
  if (working_) {
    const I2cBus::State state = bus_.state();
    if (state == I2cBus::kBusy) return;
    transfer_ended(state == I2cBus::kIdle);
  }
  if (working_ || !bus_.claim(this)) return;
  begin_job(now_ms);
  if (!working_) bus_.release();
}

void Haptics::begin_job(uint32_t now_ms) {
  const uint8_t due = due_ & present_;
  if (due != 0) {
    uint8_t rod = first_;
    while ((due >> rod & 1) == 0) rod = (rod + 1u) & (kMotors - 1u);
    first_ = (rod + 1u) & (kMotors - 1u);
    value_ = motors_[rod].wanted;
    begin_job_of(rod, false);
    return;
  }
  if (present_ == 0xFF || static_cast<int32_t>(now_ms - retry_ms_) < 0) return;
  retry_ms_ = now_ms + (tried_ < kMotors ? kFirstMs : kRetryMs);
  if (tried_ < kMotors) ++tried_;
  do {
    probe_ = (probe_ + 1u) & (kMotors - 1u);
  } while ((present_ & 1u << probe_) != 0);
  begin_job_of(probe_, true);
}

void Haptics::begin_job_of(uint8_t rod, bool setting_up) {
  rod_ = rod;
  rod_bit_ = static_cast<uint8_t>(1u << rod);
  setting_up_ = setting_up;
  step_ = 0;
  working_ = true;
  next_write();
}

void Haptics::next_write() {
  const uint8_t at = step_ == 0 ? 0 : step_ - 1;  // index of the register write
  const Write write = setting_up_ ? kSetUp[at] : Write{kPlaybackRegister, value_};
  const uint8_t bytes[2] = {write.address, write.value};
  if (step_ != 0) {
    bus_.write(kDriver, bytes, 2);
    return;
  }
  bus_.write(kMultiplexer, &rod_bit_, 1);
  if (bus_.chain(kDriver, bytes, 2)) step_ = 1;
}

void Haptics::transfer_ended(bool good) {
  if (!good) {
    working_ = false;
    present_ = static_cast<uint8_t>(present_ & ~rod_bit_);
    // A write that failed late may have started the motor.
    if (motors_[rod_].sent != 0 || (!setting_up_ && value_ != 0 && step_ != 0)) safe_ = false;
    want(rod_, 0);
    return;
  }
  ++step_;
  if (step_ <= (setting_up_ ? kSetUpWrites : 1)) {
    next_write();
    return;
  }
  working_ = false;
  if (setting_up_) {
    present_ = static_cast<uint8_t>(present_ | rod_bit_);
    sent(rod_, 0);
  } else {
    sent(rod_, value_);
  }
}

}  // namespace firmware
