// Assembles eleven bits into a byte: start 0, eight data bits (least significant first), odd
// parity, stop 1.
#ifndef FIRMWARE_CORE_PS2_RECEIVER_H
#define FIRMWARE_CORE_PS2_RECEIVER_H

#include <stdint.h>

namespace firmware {

class Ps2Receiver {
 public:
  enum Event : uint8_t {
    kNone,
    kByte,          // byte() is complete
    kParityError,   // parity error: the byte boundary is known, the value is not
    kFramingError,  // wrong start or stop bit, or the clock stopped within a byte
  };

  // Handles a falling clock edge with its data bit, 0 or not 0. tick counts samples of 20 us and
  // wraps. sweep() must be called at least every 4 ms, otherwise a gap aliases.
  Event edge(uint8_t tick, uint8_t bit) {
    const uint8_t gap = gap_before(tick);
    return data_bit(gap, bit) ? kNone : other_bit(gap, bit);
  }
  // edge() in three parts, for a caller that handles 50,000 edges a second: the ticks since the
  // last edge; then a data bit of a byte in progress, which is nearly every edge; then all other
  // bits.
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
  // Detects silence. Returns kFramingError if the clock stopped within a byte.
  Event sweep(uint8_t tick);
  void reset();

  uint8_t byte() const { return shift_; }
  // The byte's start bit came after at least kPacketGap of silence, so it starts a packet.
  bool after_gap() const { return after_gap_; }
  bool busy() const { return count_ != kStart && count_ != kHunting; }

  // Bits of a byte are at most 100 us apart; 300 us of silence ends it. A shorter limit would split
  // the bytes of slow mice. A longer one would take the next byte's start bit for a late stop bit.
  static const uint8_t kBitGap = 15;  // ticks
  // Bytes of a packet follow within a few hundred us. At 200 packets a second and 10 kHz, packets
  // are 1.1 ms apart.
  static const uint8_t kPacketGap = 50;  // ticks

 private:
  Event start(uint8_t gap, bool bit);
  Event finish(bool stop);
  Event fail();

  // Values of count_ besides the number of bits received, 1 to 10.
  enum : uint8_t {
    kStart = 0,
    kParity = 9,
    kStop = 10,
    kHunting = 255,  // out of sync: ignores edges until kBitGap of silence
  };

  uint8_t count_ = kStart;
  uint8_t shift_ = 0;
  uint8_t last_tick_ = 0;
  uint8_t parity_ = 0;  // parity bit; any non-zero value is 1
  bool idle_ = true;    // kBitGap of silence since the last edge
  bool quiet_ = true;   // kPacketGap of silence since the last start bit
  bool after_gap_ = true;
};

}  // namespace firmware

#endif
