#include "core/mouse_host.h"

#include "core/saturating.h"

namespace firmware {

MouseHost::MouseHost()
    : links_{{lines_, 0}, {lines_, 1}, {lines_, 2}, {lines_, 3},
             {lines_, 4}, {lines_, 5}, {lines_, 6}, {lines_, 7}} {}

void MouseHost::poll(uint32_t now_us) {
  while (now_us - ms_began_us_ >= 1000) {
    ms_began_us_ += 1000;
    ++now_ms_;
  }
  take_edges();
  open_gate();
  // Read after the ring is empty: a tick older than the newest edge would look like a long silence.
  const uint8_t tick = lines_.tick();
  turn_tick_ = tick;
  note(turn_, links_[turn_].step(tick, now_ms_, gate_open_));
  turn_ = static_cast<uint8_t>((turn_ + 1) % kMice);
}

template <uint8_t MOUSE>
FIRMWARE_INLINE void MouseHost::take_edge(const Edges& edges) {
  const uint8_t mask = static_cast<uint8_t>(1u << MOUSE);
  if ((edges.fell & mask) == 0) return;
  const uint8_t bit = static_cast<uint8_t>(edges.data & mask);
  const uint8_t gap = links_[MOUSE].gap_before(edges.tick);
  if (!links_[MOUSE].data_bit(gap, bit)) other_bit(links_[MOUSE], gap, bit);
}

void MouseHost::take_edges() {
  Edges edges;
  while (lines_.pop(edges)) {
    take_edge<0>(edges);
    take_edge<1>(edges);
    take_edge<2>(edges);
    take_edge<3>(edges);
    take_edge<4>(edges);
    take_edge<5>(edges);
    take_edge<6>(edges);
    take_edge<7>(edges);
  }
}

void MouseHost::other_bit(MouseLink& link, uint8_t gap, uint8_t bit) {
  const MouseLink::Event event = link.other_bit(gap, bit, now_ms_);
  if (event != MouseLink::kNone) note(link.mouse(), event);
}

void MouseHost::note(uint8_t mouse, MouseLink::Event event) {
  switch (event) {
    case MouseLink::kNone:
      break;
    case MouseLink::kMovement: {
      const Movement& moved = links_[mouse].movement();
      slide_[mouse] = static_cast<uint16_t>(slide_[mouse] + static_cast<uint16_t>(moved.slide));
      spin_[mouse] = static_cast<uint16_t>(spin_[mouse] + static_cast<uint16_t>(moved.spin));
      if (moved.overflow) overflow_ = static_cast<uint8_t>(overflow_ | (1u << mouse));
      break;
    }
    case MouseLink::kResync:
      resynchronised_ = true;
      break;
    case MouseLink::kError:
      count_errors(1);
      break;
  }
}

void MouseHost::count_errors(uint8_t errors) {
  quality_ = add_saturating(quality_, errors);
}

void MouseHost::open_gate() {
  if (gate_open_ || !allowed_) return;
  if (now_ms_ < kWaitForAllMs) {
    for (uint8_t mouse = 0; mouse < kMice; ++mouse) {
      if (!links_[mouse].waits_at_gate()) return;
    }
  }
  gate_open_ = true;
}

void MouseHost::make_frame(uint32_t now_us, wire::DeviceFrame& frame) {
  const uint8_t dropped = lines_.dropped();
  count_errors(static_cast<uint8_t>(dropped - dropped_before_));
  dropped_before_ = dropped;
  frame.flags = resynchronised_ ? 1 : 0;
  frame.sequence = sequence_++;
  frame.time_us = now_us;
  frame.present = 0;
  uint8_t bit = 1;
  for (uint8_t mouse = 0; mouse < kMice; ++mouse, bit = static_cast<uint8_t>(bit << 1)) {
    frame.slide[mouse] = slide_[mouse];
    frame.spin[mouse] = spin_[mouse];
    if (links_[mouse].present()) frame.present = static_cast<uint8_t>(frame.present | bit);
  }
  frame.overflow = overflow_;
  frame.quality = quality_;
  frame.index = 0;
  resynchronised_ = false;
  overflow_ = 0;
  quality_ = 0;
}

}  // namespace firmware
