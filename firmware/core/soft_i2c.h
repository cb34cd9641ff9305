// An I2C master on two open-drain lines, in steps: each gives the clocks of a byte at most, and
// none waits for a part. A line is pulled low or let go, never driven high. Interrupts may come at
// any time: they stretch a clock.
//
// A part that was cut off while it sent may hold the data line for up to nine clocks: those are
// given before a transfer, and the bus is ended (UM10204, 3.1.16). A part may stretch the clock for
// kStretchTicks; then the transfer has failed, and both lines are let go.
#ifndef FIRMWARE_CORE_SOFT_I2C_H
#define FIRMWARE_CORE_SOFT_I2C_H

#include "core/haptics.h"

namespace firmware {

// Wires: static void clock_low(), clock_free(), data_low(), data_free(); bool clock(), data();
// void settle(), in which a line that was let go rises by its pull-up, else it counts as held for
// this step; wait_high(), at least 0.6 us; wait_low(), so that together with what a step does
// between a clock is low for 1.3 us. The tests measure both.
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

  // tick: of 20 us, wraps; while busy() a step comes at least every 2 ms.
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

  static const uint8_t kPulseSteps = 9;  // of a motor, 40 us at most each
  static const bool kRunsByItself = false;

  static const uint8_t kStretchTicks = 50;  // 1 ms
  static const uint8_t kFreeingClocks = 9;

 private:
  enum Phase : uint8_t {
    kRest,
    kBegin,  // both lines must be free
    kBit,
    kStop,
    kFree,  // clocks for a part that holds the data line
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

  // A clock that a part has stretched is high for its time from when it is found high.
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

  // All but the last that are left of the byte under way, for as long as nobody holds a line:
  // whoever does is found by the one bit that follows. Eight of them are most of a transfer's time,
  // so they stay in registers.
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

  // The same of the byte that the other sends.
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
      Wires::settle();  // less is done meanwhile than where a bit is sent
    }
    shift_ = shift;
    bit_ = bit;
  }

  // The clock is high, bit_ on the data line.
  void end_bit() {
    const bool high = Wires::data();
    Wires::clock_low();
    if (bit_ < 8) {
      if (taking_) {
        shift_ = static_cast<uint8_t>(shift_ << 1 | (high ? 1 : 0));
      } else if (sent_high_ && !high) {
        give_up();  // somebody holds it
        return;
      }
    }
    ++bit_;
    if (bit_ < 8) {
      present();
    } else if (bit_ == 8) {
      Wires::data_free();  // for the acknowledge; the one byte that is read gets none
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
        if (clocks_ != 0) {  // the bus is free: now the transfer
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
  uint8_t shift_ = 0;  // what is left of the byte under way
  uint8_t at_ = 0;     // bytes of bytes_, or read ones, that have begun
  uint8_t size_ = 0;
  uint8_t bit_ = 0;  // 8: the acknowledge
  bool reads_ = false;
  bool taking_ = false;  // the byte under way is the other's
  bool sent_high_ = false;
  bool failed_ = false;
  bool freed_ = false;  // clocks were given to free the bus
  uint8_t clocks_ = 0;  // left of those
  bool waiting_ = false;
  uint8_t since_ = 0;  // when the clock was first found low
};

}  // namespace firmware

#endif
