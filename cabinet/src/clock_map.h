// The host's time as the device's clock: the frame that came with the least delay says how far the
// two are apart.
#pragma once

#include <algorithm>
#include <cstdint>

namespace cabinet {

class ClockMap {
 public:
  // A frame of the device's time came at the host's, or was found there by then.
  void frame(std::int64_t device_us, std::int64_t host_us) {
    const std::int64_t apart = host_us - device_us;
    if (!started_ || host_us - began_us_ > kWindowUs) {
      before_ = started_ ? least_ : apart;
      least_ = apart;
      began_us_ = host_us;
    }
    started_ = true;
    least_ = std::min(least_, apart);
  }
  std::int64_t device_us(std::int64_t host_us) const { return host_us - std::min(least_, before_); }
  void reset() { started_ = false; }

 private:
  // Long enough to find a frame that was hardly delayed, short enough for two clocks that differ by
  // half a percent to stay within 0.6 ms.
  static constexpr std::int64_t kWindowUs = 64'000;
  bool started_ = false;
  std::int64_t began_us_ = 0, least_ = 0, before_ = 0;
};

}  // namespace cabinet
