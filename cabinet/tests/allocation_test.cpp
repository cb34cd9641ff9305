// Once warm, a poll takes no memory: the server's loop calls it 1000 times a second.
#include <gtest/gtest.h>

#include <memory>

#include "cabinet/device_source.h"
#include "cabinet/hand.h"
#include "cabinet/source_mux.h"
#include "counting_new.h"
#include "simulated_device.h"

using namespace cabinet;
using namespace cabinet_test;

namespace {

TEST(Allocation, PollingThroughFramesNoiseUnplugAndReplugTakesNoMemory) {
  SerialLine line;
  line.plug();
  DeviceSource device(DeviceOptions{}, [&line] { return line.open(); });
  Hand hand(HandOptions{});
  std::array<double, kRods> limit;
  limit.fill(0.2);
  SourceMux mux(limit);
  const int order[] = {mux.add(device, Origin::relative), mux.add(hand, Origin::absolute)};
  for (int rod = 0; rod < kRods; ++rod) mux.assign(rod, order);
  SimulatedDevice simulated;
  std::int64_t now_us = 0;
  mux.poll(now_us);

  long taken = 0;
  for (int i = 0; i < 2'000; ++i) {
    if (i == 1'000) line.unplug();
    if (i == 1'100) line.plug();
    if (i < 1'000 || i >= 1'400) {
      Bytes bytes = cobs(simulated.frame());
      if (i % 7 == 0) bytes[9] = 0;  // and now and then a broken one
      line.master.send(bytes);
    }
    const long before = os::testing::allocations();
    mux.poll(now_us += 1'000);
    taken += os::testing::allocations() - before;
  }
  EXPECT_EQ(taken, 0);
  EXPECT_EQ(device.counters().reopened, 1u);
  EXPECT_GT(device.counters().bad, 200u);
  EXPECT_GT(device.counters().frames, 1'300u);
  const long before = os::testing::allocations();
  const auto held = std::make_unique<Bytes>(100);
  EXPECT_GT(os::testing::allocations(), before);  // the counter counts
}

}  // namespace
