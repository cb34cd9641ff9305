// Eight motors, one a rod: each behind a driver chip of the DRV2605 class, all drivers at one
// address, so behind a multiplexer of the TCA9548A class. A driver is in real-time playback: its
// motor runs as its register says until that is written again, so what bounds a pulse is here: its
// length, and what a motor gets on average.
//
// Nothing waits: poll() moves one transfer on. A driver that does not acknowledge is absent and is
// tried again later.
#ifndef FIRMWARE_CORE_HAPTICS_H
#define FIRMWARE_CORE_HAPTICS_H

#include <stdint.h>

#include "wire/device_command.h"

namespace firmware {

static const uint8_t kMotors = wire::kDeviceRods;

class I2cBus {
 public:
  enum State : uint8_t { kIdle, kBusy, kFailed };  // kFailed: not acknowledged, or the bus is stuck
  // Begins a write of 1 or 2 bytes. Precondition: state() is not kBusy.
  virtual void write(uint8_t address, const uint8_t* bytes, uint8_t size) = 0;
  // Of the last write, and of one that was chained to it.
  virtual State state() = 0;
  // A write that begins by itself where the one that was begun last ends well. False: this bus has
  // no such thing.
  virtual bool chain(uint8_t, const uint8_t*, uint8_t) { return false; }

  // Who uses the bus has it until the end of its last transfer is seen. False: another has it.
  bool claim(const void* who) {
    if (user_ != nullptr && user_ != who) return false;
    user_ = who;
    return true;
  }
  void release() { user_ = nullptr; }

 protected:
  ~I2cBus() = default;

 private:
  const void* user_ = nullptr;
};

class I2cReadBus : public I2cBus {
 public:
  // Begins a read of one byte; state() is of this too. Precondition: state() is not kBusy.
  virtual void read(uint8_t address) = 0;
  // That was read last. Precondition: state() is kIdle after it.
  virtual uint8_t byte() = 0;

 protected:
  ~I2cReadBus() = default;
};

class Haptics {
 public:
  explicit Haptics(I2cBus& bus) : bus_(bus) {}

  void pulse(uint8_t rod, uint8_t amplitude, uint16_t duration_ms, uint32_t now_ms);
  void all_off();
  // Off: no pulse is played until it is on again.
  void allow(bool allowed);
  // At least once a millisecond.
  void poll(uint32_t now_ms);

  // A motor has yet to be told something.
  bool waits() const { return (due_ & present_) != 0; }

  uint8_t present() const { return present_; }
  // False after a driver whose motor runs could not be told to stop: the line that enables the
  // drivers must go low, for which all are set up anew.
  bool safe() const { return safe_; }
  void made_safe();

  static constexpr uint8_t kMultiplexer = 0x70, kDriver = 0x5A;
  static constexpr uint16_t kRetryMs =
      125;                                 // between attempts, of one absent driver after the other
  static constexpr uint16_t kFirstMs = 2;  // the same in the first round
  // A motor at full amplitude for a pulse of the longest kind, then a quarter of that on average.
  static constexpr uint16_t kMaxCredit = 255u * wire::kMaxPulseMs;
  static constexpr uint16_t kCreditPerMs = 64;
  static_assert(255u * wire::kMaxPulseMs <= 0xFFFF - kCreditPerMs, "16 bits hold it");

 private:
  struct Motor {
    uint8_t wanted = 0;
    uint8_t sent = 0;
    uint16_t left_ms = 0;
    uint16_t credit = kMaxCredit;
  };

  // Apart from poll(), so that what most calls do saves no registers for them.
  void pass_time(uint32_t now_ms) __attribute__((noinline));
  void pass_ms();
  void want(uint8_t rod, uint8_t amplitude);
  void sent(uint8_t rod, uint8_t amplitude);
  void transfer_ended(bool good) __attribute__((noinline));
  void begin_job(uint32_t now_ms) __attribute__((noinline));
  void begin_job_of(uint8_t rod, bool setting_up);
  void next_write();

  I2cBus& bus_;
  Motor motors_[kMotors];
  uint8_t stirred_ = 0;  // motors that run or have less than all of their credit, a bit each
  uint8_t due_ = 0;      // motors whose register has not what is wanted
  uint8_t present_ = 0;
  bool allowed_ = true;
  bool safe_ = true;
  uint32_t now_ms_ = 0;
  bool begun_ = false;

  // The job in hand: the multiplexer, then one register or those of setting up.
  bool working_ = false;
  bool setting_up_ = false;
  uint8_t rod_ = 0, rod_bit_ = 0;
  uint8_t value_ = 0;  // that the register gets
  uint8_t step_ = 0;   // 0: the multiplexer
  uint8_t probe_ = 0;  // the next absent one to be tried
  uint8_t first_ = 0;  // where the search for work begins
  uint8_t tried_ = 0;  // of the first round
  uint32_t retry_ms_ = 0;
};

}  // namespace firmware

#endif
