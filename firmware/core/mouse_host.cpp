#include "core/mouse_host.h"

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
  // Read after the ring is emptied: a tick older than the newest edge would look like a long
  // silence.
  const uint8_t tick = lines_.tick();
  turn_tick_ = tick;
  note(turn_, links_[turn_].step(tick, now_ms_, gate_open_));
  turn_ = static_cast<uint8_t>((turn_ + 1) % kMice);
}

void MouseHost::take_edges() {
  const uint16_t now_ms = now_ms_;
  Edges edges;
  while (lines_.pop(edges)) {
    MouseLink* link = links_;
    uint8_t fell = edges.fell, data = edges.data;
    if ((fell & 0x0F) == 0) {
      link += 4;
      fell = static_cast<uint8_t>(fell >> 4);
      data = static_cast<uint8_t>(data >> 4);
    }
    for (; fell != 0; fell = static_cast<uint8_t>(fell >> 1), ++link) {
      if ((fell & 1) != 0) {
        const MouseLink::Event event = link->edge(edges.tick, data & 1, now_ms);
        if (event != MouseLink::kNone) note(static_cast<uint8_t>(link - links_), event);
      }
      data = static_cast<uint8_t>(data >> 1);
    }
  }
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
  quality_ = static_cast<uint8_t>(errors > 255 - quality_ ? 255 : quality_ + errors);
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
  resynchronised_ = false;
  overflow_ = 0;
  quality_ = 0;
}

}  // namespace firmware
