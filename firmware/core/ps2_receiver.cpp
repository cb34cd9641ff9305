#include "core/ps2_receiver.h"

#include "core/ps2_parity.h"

namespace firmware {

Ps2Receiver::Event Ps2Receiver::fail() {
  count_ = kHunting;
  return kFramingError;
}

Ps2Receiver::Event Ps2Receiver::other_bit(uint8_t gap, uint8_t bit) {
  if (gap <= kBitGap) {
    if (count_ == kParity) {
      parity_ = bit;
      count_ = kStop;
      return kNone;
    }
    if (count_ == kStop) return finish(bit != 0);
  }
  return start(gap, bit != 0);
}

Ps2Receiver::Event Ps2Receiver::start(uint8_t gap, bool bit) {
  Event broken = kNone;
  if (gap > kPacketGap) quiet_ = true;
  if (gap > kBitGap || idle_) {
    if (busy()) broken = kFramingError;
    count_ = kStart;
    idle_ = false;
  }
  if (count_ == kHunting) {
    // More than one stray edge: the start bit of this byte was missed, so no packet starts here.
    quiet_ = false;
    return kNone;
  }
  if (bit) return fail();
  after_gap_ = quiet_;
  quiet_ = false;
  count_ = 1;
  return broken;
}

Ps2Receiver::Event Ps2Receiver::finish(bool stop) {
  if (!stop) return fail();
  count_ = kStart;
  return odd_ones(shift_) != (parity_ != 0) ? kByte : kParityError;
}

Ps2Receiver::Event Ps2Receiver::sweep(uint8_t tick) {
  const uint8_t gap = static_cast<uint8_t>(tick - last_tick_);
  if (gap > kPacketGap) quiet_ = true;
  if (gap <= kBitGap) return kNone;
  const bool cut_off = busy();
  idle_ = true;
  count_ = kStart;
  return cut_off ? kFramingError : kNone;
}

void Ps2Receiver::reset() {
  count_ = kStart;
  idle_ = true;
}

}  // namespace firmware
