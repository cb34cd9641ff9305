#include "core/ps2_receiver.h"

namespace firmware {

namespace {

uint8_t odd_ones(uint8_t value) {
  value = static_cast<uint8_t>(value ^ (value >> 4));
  value = static_cast<uint8_t>(value ^ (value >> 2));
  value = static_cast<uint8_t>(value ^ (value >> 1));
  return value & 1;
}

}  // namespace

Ps2Receiver::Event Ps2Receiver::fail() {
  count_ = kHunting;
  return kFramingError;
}

Ps2Receiver::Event Ps2Receiver::unusual(uint8_t gap, uint8_t bit) {
  Event broken = kNone;
  if (gap > kPacketGap) quiet_ = true;
  if (gap > kBitGap || idle_) {
    if (busy()) broken = kFramingError;
    count_ = kStart;
    idle_ = false;
  }
  switch (count_) {
    case kStart:
      if (bit != 0) return fail();
      after_gap_ = quiet_;
      quiet_ = false;
      count_ = 1;
      return broken;
    case kParity:
      parity_ = bit;
      count_ = kStop;
      return kNone;
    case kStop:
      return finish(bit != 0);
    default:
      // Hunting, and more than one stray edge: this is a byte whose start was missed, so no packet
      // begins here.
      quiet_ = false;
      return kNone;
  }
}

Ps2Receiver::Event Ps2Receiver::finish(bool stop) {
  if (!stop) return fail();
  count_ = kStart;
  return odd_ones(shift_) != parity_ ? kByte : kParityError;
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
