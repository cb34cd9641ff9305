// Eight mice and the frame with their counts. The interrupt calls sample() of lines(); one polling
// loop calls all else.
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

  // Whether poll() is due: kTurnTicks samples have passed. Until then the loop may sleep.
  bool due() const { return static_cast<uint8_t>(lines_.tick() - turn_tick_) >= kTurnTicks; }
  // Processes all recorded edges and advances one link. Call at least every 0.5 ms, so that each
  // link advances within 4 ms. now_us wraps.
  void poll(uint32_t now_us);

  // If true, mice are enabled all together once each is set up or kWaitForAllMs have passed. A
  // mouse that appears later is enabled at once.
  void allow_streaming(bool allowed) { allowed_ = allowed; }

  // Fills a frame with counts since power-on and the events since the last call.
  void make_frame(uint32_t now_us, wire::DeviceFrame& frame);

  // Counts since power-on, wrapping.
  uint16_t slide(uint8_t mouse) const { return slide_[mouse]; }
  uint16_t spin(uint8_t mouse) const { return spin_[mouse]; }

  Ps2Lines& lines() { return lines_; }
  const MouseLink& link(uint8_t mouse) const { return links_[mouse]; }

  // How long the other mice wait for one that is missing at power-on: a self-test may take 750 ms.
  static const uint16_t kWaitForAllMs = 1500;
  // 200 us: a sixth of the ring's capacity, and a step for each link every 1.6 ms.
  static const uint8_t kTurnTicks = 10;

 private:
  // Separate from poll(), so that the compiler can use all registers. take_edge() is instantiated
  // for each mouse, so that testing a bit takes two cycles: a loop took a tenth of the processor
  // time.
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
