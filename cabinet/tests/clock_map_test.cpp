#include "clock_map.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

using namespace cabinet;

namespace {

// Ten minutes of frames with delays of up to 5 ms, from clocks that are half a percent off.
TEST(ClockMap, FollowsAClockThatRunsFastOrSlow) {
  for (const double rate : {0.995, 1.0, 1.005}) {
    ClockMap map;
    std::mt19937 random(1);
    double worst = 0;
    for (std::int64_t host = 0; host < 600'000'000; host += 1'000) {
      const auto device = static_cast<std::int64_t>(static_cast<double>(host) * rate);
      map.frame(device, host + static_cast<std::int64_t>(random() % 5'000));
      if (host < 1'000'000) continue;
      const auto seen = static_cast<double>(map.device_us(host));
      worst = std::max(worst, std::abs(seen - static_cast<double>(device)));
    }
    EXPECT_LT(worst, 1'000) << rate;  // 0.5 % of the 128 ms of history: 640
  }
}

}  // namespace
