// Eleven bits into a byte: start 0, eight data bits (least significant first), odd parity, stop 1.
#ifndef FIRMWARE_CORE_PS2_RECEIVER_H
#define FIRMWARE_CORE_PS2_RECEIVER_H

#include <stdint.h>

namespace firmware {

class Ps2Receiver {
 public:
  enum Event : uint8_t {
    kNone,
    kByte,          // byte() is whole
    kParityError,   // eleven bits, parity wrong: the place of the byte is known, its value is not
    kFramingError,  // start or stop wrong, or the clock stopped in the middle
  };

  // A falling clock edge with its data bit, 0 or not 0. tick counts samples of 20 us and wraps;
  // sweep() must be called at least every 4 ms, or a gap would alias.
  Event edge(uint8_t tick, uint8_t bit) {
    const uint8_t gap = gap_before(tick);
    return data_bit(gap, bit) ? kNone : other_bit(gap, bit);
  }
  // edge() in three parts, for a caller that handles 50,000 of them a second: the ticks since the
  // last edge; then a data bit of a byte under way, which is nearly every one; if it was none, the
  // rest.
  uint8_t gap_before(uint8_t tick) {
    const uint8_t gap = static_cast<uint8_t>(tick - last_tick_);
    last_tick_ = tick;
    return gap;
  }
  bool data_bit(uint8_t gap, uint8_t bit) {
    const uint8_t count = count_;
    if (static_cast<uint8_t>(count - 1) >= 8 || gap > kBitGap) return false;
    count_ = static_cast<uint8_t>(count + 1);
    uint8_t shift = shift_;
    shift >>= 1;
    if (bit != 0) shift = static_cast<uint8_t>(shift | 0x80);
    shift_ = shift;
    return true;
  }
  Event other_bit(uint8_t gap, uint8_t bit);
  // Notices silence. kFramingError when the clock stopped within a byte.
  Event sweep(uint8_t tick);
  void reset();

  uint8_t byte() const { return shift_; }
  // The byte's start bit came after at least kPacketGap of silence: it begins a packet.
  bool after_gap() const { return after_gap_; }
  bool busy() const { return count_ != kStart && count_ != kHunting; }

  // Bits of a byte are at most 100 us apart; 300 us without one ends it. Shorter would cut slow
  // mice in half, longer would take the next byte's start bit for a late stop bit.
  static const uint8_t kBitGap = 15;  // ticks
  // Bytes of a packet follow within a few hundred us; packets at 200 a second and 10 kHz have 1.1
  // ms between them.
  static const uint8_t kPacketGap = 50;  // ticks

 private:
  Event start(uint8_t gap, bool bit);
  Event finish(bool stop);
  Event fail();

  // What count_ says besides the bits taken of this byte, 1 to 10.
  enum : uint8_t {
    kStart = 0,
    kParity = 9,
    kStop = 10,
    kHunting = 255,  // out of step: nothing counts until kBitGap of silence
  };

  uint8_t count_ = kStart;
  uint8_t shift_ = 0;
  uint8_t last_tick_ = 0;
  uint8_t parity_ = 0;  // the parity bit: not 0 for 1
  bool idle_ = true;    // kBitGap of silence noticed since the last edge
  bool quiet_ = true;   // kPacketGap of silence noticed since the last byte began
  bool after_gap_ = true;
};

}  // namespace firmware

#endif
