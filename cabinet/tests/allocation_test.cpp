// Once warm, a poll allocates no memory: the server's loop calls it 1000 times a second.
#include <gtest/gtest.h>
#include <linux/input.h>

#include <cstring>
#include <memory>
#include <utility>

#include "cabinet/device_source.h"
#include "cabinet/hand.h"
#include "cabinet/mouse_source.h"
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
      if (i % 7 == 0) bytes[9] = 0;  // an invalid one now and then
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
  EXPECT_GT(os::testing::allocations(), before);  // check that allocations are counted
}

TEST(Allocation, PollingAMouseTakesNoMemory) {
  int ends[2] = {-1, -1};
  ASSERT_EQ(socketpair(AF_UNIX, SOCK_STREAM, 0, ends), 0);
  const Descriptor far(ends[0]);
  MouseSource mouse(MouseOptions{}, [&ends] { return std::exchange(ends[1], -1); });
  std::int64_t now_us = 1'000'000;
  mouse.poll(now_us);
  std::array<input_event, 2> events{};
  events[0].type = EV_REL;
  events[0].code = REL_X;
  events[0].value = 3;
  Bytes bytes(sizeof events);
  std::memcpy(bytes.data(), events.data(), bytes.size());
  long taken = 0;
  for (int i = 0; i < 500; ++i) {
    far.send(bytes);
    const long before = os::testing::allocations();
    mouse.poll(now_us += 1'000);
    taken += os::testing::allocations() - before;
  }
  EXPECT_EQ(taken, 0);
  EXPECT_EQ(mouse.counters().frames, 500u);
}

}  // namespace
