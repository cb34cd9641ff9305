// Eight mice and the frame made of them. sample() of lines() belongs to the interrupt, all else to
// one polling loop.
#ifndef FIRMWARE_CORE_MOUSE_HOST_H
#define FIRMWARE_CORE_MOUSE_HOST_H

#include <stdint.h>

#include "core/mouse_link.h"
#include "core/ps2_lines.h"
#include "wire/device_frame.h"

namespace firmware {

static_assert(kMice == wire::kDeviceRods, "one mouse for each rod");

class MouseHost {
 public:
  MouseHost();

  // It is time for poll(): kTurnTicks samples have passed. Until then the loop may sleep.
  bool due() const { return static_cast<uint8_t>(lines_.tick() - turn_tick_) >= kTurnTicks; }
  // Takes in all edges heard and moves one link on. At least every 0.5 ms, so that each link's turn
  // comes within 4 ms. now_us wraps.
  void poll(uint32_t now_us);

  // Mice are enabled, all together, once this is true and each is set up or has been waited for
  // long enough. A mouse that comes later is enabled at once.
  void allow_streaming(bool allowed) { allowed_ = allowed; }

  // Counts since power-on, and what happened since the last call.
  void make_frame(uint32_t now_us, wire::DeviceFrame& frame);

  // Counts since power-on, wrapping.
  uint16_t slide(uint8_t mouse) const { return slide_[mouse]; }
  uint16_t spin(uint8_t mouse) const { return spin_[mouse]; }

  Ps2Lines& lines() { return lines_; }
  const MouseLink& link(uint8_t mouse) const { return links_[mouse]; }

  // Mice that are not there at power-on hold the others back for so long: a self-test may take 750
  // ms.
  static const uint16_t kWaitForAllMs = 1500;
  // 200 us: a sixth of what the ring holds, and a turn for each link every 1.6 ms.
  static const uint8_t kTurnTicks = 10;

 private:
  // Apart from poll(), so that the compiler has all registers for it; one copy of take_edge() for
  // each mouse, so that testing a bit takes two cycles: a loop took a tenth of the processor.
  void take_edges() __attribute__((noinline));
  template <uint8_t MOUSE>
  FIRMWARE_INLINE void take_edge(const Edges& edges);
  void other_bit(MouseLink& link, uint8_t gap, uint8_t bit) __attribute__((noinline));
  void note(uint8_t mouse, MouseLink::Event event);
  void open_gate();
  void count_errors(uint8_t errors);

  Ps2Lines lines_;
  MouseLink links_[kMice];
  uint16_t slide_[kMice] = {};
  uint16_t spin_[kMice] = {};
  uint32_t ms_began_us_ = 0;
  uint16_t now_ms_ = 0;
  uint16_t sequence_ = 0;
  uint8_t turn_ = 0;
  uint8_t turn_tick_ = 0;
  uint8_t dropped_before_ = 0;
  bool allowed_ = false;
  bool gate_open_ = false;
  bool resynchronised_ = false;
  uint8_t overflow_ = 0;
  uint8_t quality_ = 0;
};

}  // namespace firmware

#endif
