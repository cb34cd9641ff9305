// The core on the PC: eight simulated mice on wires that the core samples and drives, without a
// micro-controller. Sampling and polling happen when the board would do them.
#pragma once

#include <array>
#include <cstdint>
#include <functional>

#include "core/mouse_host.h"
#include "firmware_sim/sim_mouse.h"

namespace firmware_sim {

class HostRig {
 public:
  static constexpr std::uint64_t kSampleNs = firmware::kSampleUs * 1000ull;

  explicit HostRig(const MouseOptions& options = {}, std::uint64_t phase_ns = 0)
      : now_ns_(phase_ns) {
    for (int i = 0; i < firmware::kMice; ++i) {
      MouseOptions own = options;
      own.seed += static_cast<std::uint64_t>(i);
      mice[static_cast<std::size_t>(i)] = SimMouse(own);
    }
    host.allow_streaming(true);
  }

  void advance_us(std::uint64_t us) {
    for (const std::uint64_t end = now_ns_ + us * 1000; now_ns_ < end;) {
      now_ns_ += kSampleNs;
      std::uint8_t clock = 0, data = 0;
      for (int i = 0; i < firmware::kMice; ++i) read_wires(i, clock, data);
      host.lines().count_sample();
      host.lines().sample(clock, data, clock, [](std::uint8_t) {});
      if (host.due()) host.poll(static_cast<std::uint32_t>(now_ns_ / 1000));
    }
  }

  bool advance_until(const std::function<bool()>& done, int limit_ms) {
    for (int ms = 0; ms < limit_ms && !done(); ++ms) advance_us(1000);
    return done();
  }

  wire::DeviceFrame frame() {
    wire::DeviceFrame made{};
    host.make_frame(static_cast<std::uint32_t>(now_ns_ / 1000), made);
    return made;
  }

  std::uint8_t present() const {
    unsigned mask = 0;
    for (unsigned i = 0; i < firmware::kMice; ++i) {
      if (host.link(static_cast<std::uint8_t>(i)).present()) mask |= 1u << i;
    }
    return static_cast<std::uint8_t>(mask);
  }

  std::uint64_t now_us() const { return now_ns_ / 1000; }

  firmware::MouseHost host;
  std::array<SimMouse, firmware::kMice> mice;
  // Called with the time and wires of mouse 0 whenever one of them changes, from either side.
  std::function<void(std::uint64_t ns, bool clock, bool data)> on_wires;

 private:
  void read_wires(int i, std::uint8_t& clock, std::uint8_t& data) {
    SimMouse& mouse = mice[static_cast<std::size_t>(i)];
    const unsigned bit = 1u << i;
    const bool clock_held = (host.lines().clock_low() & bit) != 0;
    const bool data_held = (host.lines().data_low() & bit) != 0;
    while (mouse.next_event_ns() <= now_ns_) {
      const std::uint64_t at = mouse.next_event_ns();
      mouse.step(at, clock_held, data_held);
      if (i == 0) tell(at, !mouse.clock_low() && !clock_held, !mouse.data_low() && !data_held);
    }
    const bool clock_high = !mouse.clock_low() && !clock_held,
               data_high = !mouse.data_low() && !data_held;
    if (i == 0) tell(now_ns_, clock_high, data_high);
    if (clock_high) clock = static_cast<std::uint8_t>(clock | bit);
    if (data_high) data = static_cast<std::uint8_t>(data | bit);
  }

  void tell(std::uint64_t ns, bool clock, bool data) {
    if (clock == clock_ && data == data_) return;
    clock_ = clock;
    data_ = data;
    if (on_wires) on_wires(ns, clock, data);
  }

  std::uint64_t now_ns_;
  bool clock_ = true, data_ = true;
};

}  // namespace firmware_sim
