// Eight motors, one per rod. Each has a driver chip of the DRV2605 class. All drivers have the same
// address, so they are behind a multiplexer of the TCA9548A class. A driver is in real-time
// playback mode: its motor runs at the register's amplitude until the next write. So this class
// bounds a pulse: its length, and the average power of a motor.
//
// Nothing blocks: poll() advances one transfer. A driver that does not acknowledge counts as absent
// and is tried again later.
#ifndef FIRMWARE_CORE_HAPTICS_H
#define FIRMWARE_CORE_HAPTICS_H

#include <stdint.h>

#include "wire/device_command.h"

namespace firmware {

static const uint8_t kMotors = wire::kDeviceRods;

class I2cBus {
 public:
  enum State : uint8_t { kIdle, kBusy, kFailed };  // kFailed: no acknowledge, or the bus is stuck
  // Starts a write of 1 or 2 bytes. Precondition: state() is not kBusy.
  virtual void write(uint8_t address, const uint8_t* bytes, uint8_t size) = 0;
  // State of the last transfer and of a write chained to it.
  virtual State state() = 0;
  // Queues a write that starts automatically if the write in progress succeeds. False: not queued,
  // for instance because this bus does not support it.
  virtual bool chain(uint8_t, const uint8_t*, uint8_t) { return false; }

  // Claims the bus until release(), after the end of the last transfer. False: another user has it.
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
  // Starts a read of one byte; state() covers it too. Precondition: state() is not kBusy.
  virtual void read(uint8_t address) = 0;
  // The byte of the last read. Precondition: state() is kIdle after it.
  virtual uint8_t byte() = 0;

 protected:
  ~I2cReadBus() = default;
};

class Haptics {
 public:
  explicit Haptics(I2cBus& bus) : bus_(bus) {}

  void pulse(uint8_t rod, uint8_t amplitude, uint16_t duration_ms, uint32_t now_ms);
  void all_off();
  // False: stops all motors and plays no pulse until true.
  void allow(bool allowed);
  // Call at least once a millisecond.
  void poll(uint32_t now_ms);

  // A present motor's register needs a write.
  bool waits() const { return (due_ & present_) != 0; }

  uint8_t present() const { return present_; }
  // False if a write to a driver failed while its motor may be running: the enable line of the
  // drivers must go low. All drivers then need a new setup.
  bool safe() const { return safe_; }
  void made_safe();

  static constexpr uint8_t kMultiplexer = 0x70, kDriver = 0x5A;
  static constexpr uint16_t kRetryMs = 125;  // between attempts; absent drivers are tried in turn
  static constexpr uint16_t kFirstMs = 2;    // the same, for the first attempt at each driver
  // Credit for a pulse of full amplitude and maximum length; it refills at a quarter of full
  // amplitude on average.
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

  // Separate from poll(), so that most calls of poll() save no registers for them.
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
  uint8_t stirred_ = 0;  // bit i: motor i runs or has less than full credit
  uint8_t due_ = 0;      // bit i: register of motor i differs from `wanted`
  uint8_t present_ = 0;
  bool allowed_ = true;
  bool safe_ = true;
  uint32_t now_ms_ = 0;
  bool begun_ = false;

  // The current job: a write to the multiplexer, then one register or all setup registers.
  bool working_ = false;
  bool setting_up_ = false;
  uint8_t rod_ = 0, rod_bit_ = 0;
  uint8_t value_ = 0;  // to write to the register
  uint8_t step_ = 0;   // 0: the multiplexer; n: the n-th register write
  uint8_t probe_ = 0;  // next absent driver to try
  uint8_t first_ = 0;  // rod where the search for due motors starts
  uint8_t tried_ = 0;  // drivers tried so far in the first pass
  uint32_t retry_ms_ = 0;
};

}  // namespace firmware

#endif
