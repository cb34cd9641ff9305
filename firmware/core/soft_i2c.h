// An I2C controller on two open-drain lines, in steps. Each step gives at most the clocks of one
// byte, and none waits for a device. A line is pulled low or released, never driven high.
// Interrupts may occur at any time: they stretch a clock.
//
// A device that was interrupted while sending may hold the data line low for up to nine clocks.
// They are given before a transfer, followed by STOP (UM10204, 3.1.16). A device may stretch the
// clock for kStretchTicks. After that the transfer fails, and both lines are released.
#ifndef FIRMWARE_CORE_SOFT_I2C_H
#define FIRMWARE_CORE_SOFT_I2C_H

#include "core/haptics.h"

namespace firmware {

// Wires: static void clock_low(), clock_free(), data_low(), data_free(); bool clock(), data(); void
// settle(): waits until a released line has risen by its pull-up; a line still low counts as held
// low for this step; wait_high(): at least 0.6 us; wait_low(): together with the other work of a
// step between two clocks, a low period of 1.3 us. The tests measure both.
template <typename Wires>
// NOLINTNEXTLINE(cppcoreguidelines-virtual-class-destructor): final, which it misses of templates
class SoftI2c final : public I2cReadBus {
 public:
  void write(uint8_t address, const uint8_t* bytes, uint8_t size) override {
    bytes_[0] = bytes[0];
    if (size > 1) bytes_[1] = bytes[1];
    begin(static_cast<uint8_t>(address << 1), size, false);
  }
  void read(uint8_t address) override { begin(static_cast<uint8_t>(address << 1 | 1), 1, true); }
  uint8_t byte() override { return shift_; }
  State state() override { return state_; }
  bool busy() const { return state_ == kBusy; }

  // tick: unit 20 us, wraps. Call at least every 2 ms while busy().
  void step(uint8_t tick) {
    if (phase_ != kBit) {
      other_step(tick);
      return;
    }
    if (taking_) {
      take_bits();
    } else if (bit_ < 7) {
      send_bits();
    }
    clock_bit(tick);
    if (phase_ != kBit || bit_ != 8) return;
    Wires::wait_low();
    clock_bit(tick);
  }

  static const uint8_t kPulseSteps = 9;  // steps of a motor pulse, at most 40 us each
  static const bool kRunsByItself = false;

  static const uint8_t kStretchTicks = 50;  // 1 ms
  static const uint8_t kFreeingClocks = 9;

 private:
  enum Phase : uint8_t {
    kRest,
    kBegin,  // requires both lines high
    kBit,
    kStop,
    kFree,  // clocks for a device that holds the data line low
  };

  void begin(uint8_t first, uint8_t size, bool reading) {
    shift_ = first;
    at_ = 0;
    size_ = size;
    bit_ = 0;
    reads_ = reading;
    taking_ = false;
    failed_ = false;
    freed_ = false;
    clocks_ = 0;
    waiting_ = false;
    phase_ = kBegin;
    state_ = kBusy;
  }

  bool clock_is_high(uint8_t tick) {
    if (Wires::clock()) {
      waiting_ = false;
      return true;
    }
    if (!waiting_) {
      waiting_ = true;
      since_ = tick;
    } else if (static_cast<uint8_t>(tick - since_) >= kStretchTicks) {
      give_up();
    }
    return false;
  }

  void give_up() {
    Wires::data_free();
    Wires::clock_free();
    phase_ = kRest;
    state_ = kFailed;
  }

  // The high time of a stretched clock starts when it is first seen high.
  bool raise_clock(uint8_t tick) {
    Wires::clock_free();
    Wires::settle();
    if (!clock_is_high(tick)) return false;
    Wires::wait_high();
    return true;
  }

  void clock_bit(uint8_t tick) {
    if (raise_clock(tick)) end_bit();
  }

  // Sends the remaining bits of the current byte except the last, as long as no device holds a
  // line. If one does, the single bit that follows detects it. These bits take most of a transfer's
  // time, so their state stays in registers.
  void send_bits() {
    uint8_t shift = shift_, bit = bit_;
    bool high = sent_high_;
    while (bit < 7) {
      Wires::clock_free();
      Wires::settle();
      if (!Wires::clock()) break;
      Wires::wait_high();
      if (Wires::data() != high) break;
      Wires::clock_low();
      high = (shift & 0x80) != 0;
      if (high) {
        Wires::data_free();
      } else {
        Wires::data_low();
      }
      shift = static_cast<uint8_t>(shift << 1);
      ++bit;
      Wires::wait_low();
    }
    shift_ = shift;
    bit_ = bit;
    sent_high_ = high;
  }

  // Receives the bits of a byte in the same way.
  void take_bits() {
    uint8_t shift = shift_, bit = bit_;
    while (bit < 7) {
      Wires::clock_free();
      Wires::settle();
      if (!Wires::clock()) break;
      Wires::wait_high();
      const bool high = Wires::data();
      Wires::clock_low();
      shift = static_cast<uint8_t>(shift << 1 | (high ? 1 : 0));
      ++bit;
      Wires::wait_low();
      Wires::settle();  // receiving takes fewer instructions than sending a bit
    }
    shift_ = shift;
    bit_ = bit;
  }

  // Precondition: the clock is high, bit_ is on the data line.
  void end_bit() {
    const bool high = Wires::data();
    Wires::clock_low();
    if (bit_ < 8) {
      if (taking_) {
        shift_ = static_cast<uint8_t>(shift_ << 1 | (high ? 1 : 0));
      } else if (sent_high_ && !high) {
        give_up();  // another device holds the data line low
        return;
      }
    }
    ++bit_;
    if (bit_ < 8) {
      present();
    } else if (bit_ == 8) {
      Wires::data_free();  // released for the acknowledge; the one byte read is not acknowledged
    } else if (!taking_ && high) {
      failed_ = true;
      stop();
    } else {
      next_byte();
    }
  }

  void present() {
    if (taking_) {
      Wires::data_free();
      return;
    }
    sent_high_ = (shift_ & 0x80) != 0;
    if (sent_high_) {
      Wires::data_free();
    } else {
      Wires::data_low();
    }
    shift_ = static_cast<uint8_t>(shift_ << 1);
  }

  void next_byte() {
    if (at_ == size_) {
      stop();
      return;
    }
    taking_ = reads_;
    if (!taking_) shift_ = bytes_[at_];
    ++at_;
    bit_ = 0;
    present();
  }

  void stop() {
    Wires::data_low();
    phase_ = kStop;
  }

  void other_step(uint8_t tick) {
    switch (phase_) {
      case kBegin:
        if (!clock_is_high(tick)) break;
        if (!Wires::data()) {
          if (freed_) {
            give_up();
            break;
          }
          freed_ = true;
          clocks_ = kFreeingClocks;
          Wires::clock_low();
          phase_ = kFree;
          break;
        }
        Wires::data_low();
        Wires::wait_high();
        Wires::clock_low();
        present();
        phase_ = kBit;
        break;
      case kStop:
        if (!raise_clock(tick)) break;
        Wires::data_free();
        if (clocks_ != 0) {  // the bus is free: start the transfer
          clocks_ = 0;
          phase_ = kBegin;
          break;
        }
        phase_ = kRest;
        state_ = failed_ ? kFailed : kIdle;
        break;
      case kFree:
        if (!raise_clock(tick)) break;
        if (Wires::data()) {
          Wires::clock_low();
          stop();
        } else if (--clocks_ == 0) {
          give_up();
        } else {
          Wires::clock_low();
        }
        break;
      default:
        break;
    }
  }

  State state_ = kIdle;
  Phase phase_ = kRest;
  uint8_t bytes_[2] = {};
  uint8_t shift_ = 0;  // remaining bits of the current byte
  uint8_t at_ = 0;     // bytes started, of bytes_ or of the read
  uint8_t size_ = 0;
  uint8_t bit_ = 0;  // 8: acknowledge
  bool reads_ = false;
  bool taking_ = false;  // the device sends the current byte
  bool sent_high_ = false;
  bool failed_ = false;
  bool freed_ = false;  // clocks were already given to free the bus
  uint8_t clocks_ = 0;  // remaining clocks to free the bus
  bool waiting_ = false;
  uint8_t since_ = 0;  // tick at which the clock was first seen low
};

}  // namespace firmware

#endif
