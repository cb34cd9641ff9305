// Maps the host's time to the device's clock. The frame with the minimum delay gives the offset
// between the two.
#pragma once

#include <algorithm>
#include <cstdint>

namespace cabinet {

class ClockMap {
 public:
  // Records that a frame with this device time arrived at this host time, or was found by then.
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
  // Long enough to include a frame with little delay. Short enough that two clocks whose rates
  // differ by half a percent stay within 0.6 ms.
  static constexpr std::int64_t kWindowUs = 64'000;
  bool started_ = false;
  std::int64_t began_us_ = 0, least_ = 0, before_ = 0;
};

}  // namespace cabinet
