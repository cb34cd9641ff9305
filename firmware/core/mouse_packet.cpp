#include "core/mouse_packet.h"

namespace firmware {

namespace {

const uint8_t kAlwaysOne = 0x08, kSignX = 0x10, kSignY = 0x20, kOverflowX = 0x40, kOverflowY = 0x80;

int16_t delta(uint8_t low, bool negative, bool overflow) {
  if (overflow) return negative ? -256 : 255;
  return static_cast<int16_t>(negative ? low - 256 : low);
}

}  // namespace

PacketParser::Event PacketParser::byte(uint8_t value, bool good, bool after_gap) {
  Event event = kNone;
  if (after_gap) {
    lost_ = false;
    if (expire()) event = kResync;
  }
  if (lost_) return kNone;
  if (index_ == 0) {
    if (good && (value & kAlwaysOne) == 0) return kResync;
    bad_ = !good;
    head_ = value;
    index_ = 1;
    return event;
  }
  if (!good) bad_ = true;
  if (index_ == 1) {
    x_ = value;
    index_ = 2;
    return event;
  }
  return finish(value);
}

PacketParser::Event PacketParser::finish(uint8_t y) {
  index_ = 0;
  if (bad_) return kResync;
  const bool over_x = (head_ & kOverflowX) != 0, over_y = (head_ & kOverflowY) != 0;
  movement_.slide = delta(x_, (head_ & kSignX) != 0, over_x);
  movement_.spin = delta(y, (head_ & kSignY) != 0, over_y);
  movement_.overflow = over_x || over_y;
  return kMovement;
}

void PacketParser::lose() {
  index_ = 0;
  lost_ = true;
}

void PacketParser::reset() {
  index_ = 0;
  lost_ = false;
}

bool PacketParser::expire() {
  const bool unfinished = index_ != 0;
  index_ = 0;
  return unfinished;
}

}  // namespace firmware
