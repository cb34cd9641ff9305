#include "core/ps2_lines.h"

#include "core/ps2_parity.h"

namespace firmware {

namespace {

uint8_t bit_of(uint8_t mouse) {
  return static_cast<uint8_t>(1u << mouse);
}

// Stores bit i of value as the mouse's bit in plane i. The other bits belong to mice that may be
// sending now, so each byte is written with the interrupt blocked. It is not blocked for all bytes
// at once, since a mouse that clocks a bit out of the host waits only 30 us.
void set_planes(volatile uint8_t* planes, uint8_t count, uint8_t bit, uint16_t value) {
  for (uint8_t i = 0; i < count; ++i) {
    const bool one = (value & 1) != 0;
    value = static_cast<uint16_t>(value >> 1);
    SamplingHeld held;
    planes[i] = static_cast<uint8_t>(one ? planes[i] | bit : planes[i] & ~bit);
  }
}

}  // namespace

void Ps2Lines::inhibit(uint8_t mouse) {
  const uint8_t bit = bit_of(mouse);
  SamplingHeld held;
  clock_low_ = static_cast<uint8_t>(clock_low_ | bit);
  level_ = static_cast<uint8_t>(level_ & ~bit);
  drive_lines(clock_low_, data_low_);
}

void Ps2Lines::release(uint8_t mouse) {
  const uint8_t others = static_cast<uint8_t>(~bit_of(mouse));
  SamplingHeld held;
  sending_ = static_cast<uint8_t>(sending_ & others);
  data_low_ = static_cast<uint8_t>(data_low_ & others);
  clock_low_ = static_cast<uint8_t>(clock_low_ & others);
  drive_lines(clock_low_, data_low_);
}

void Ps2Lines::send(uint8_t mouse, uint8_t value) {
  const uint8_t bit = bit_of(mouse);
  const uint8_t others = static_cast<uint8_t>(~bit);
  const uint16_t parity = odd_ones(value) ? 0 : 0x100, stop = 0x200;
  const uint16_t bits = static_cast<uint16_t>(value | parity | stop);
  set_planes(planes_, kPlanes, bit, bits);
  set_planes(left_, kCounterPlanes, bit, kPlanes);
  SamplingHeld held;
  acknowledged_ = static_cast<uint8_t>(acknowledged_ & others);
  sending_ = static_cast<uint8_t>(sending_ | bit);
  data_low_ = static_cast<uint8_t>(data_low_ | bit);  // the start bit
  clock_low_ = static_cast<uint8_t>(clock_low_ & others);
  drive_lines(clock_low_, data_low_);
}

}  // namespace firmware
