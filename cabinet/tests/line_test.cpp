// A line is exclusive and reports when bytes arrived.
#include <gtest/gtest.h>
#include <sys/ioctl.h>

#include <cerrno>
#include <chrono>
#include <thread>

#include "arrival_watch.h"
#include "exclusive_line.h"
#include "os/clock.h"
#include "os/file_descriptor.h"
#include "simulated_device.h"

using namespace cabinet;
using namespace cabinet_test;

namespace {

TEST(ExclusiveLine, TheSecondIsToldThatItIsBusyUntilTheFirstEnds) {
  SerialLine line;
  line.plug();
  os::FileDescriptor first(open_exclusively(line.path.c_str()));
  ASSERT_TRUE(first);
  EXPECT_EQ(open_exclusively(line.path.c_str()), -1);
  EXPECT_EQ(errno, EBUSY);
  int exclusive = 0;
  ASSERT_EQ(::ioctl(first.get(), TIOCGEXCL, &exclusive), 0);
  EXPECT_EQ(exclusive, 1);
  first.reset();
  const os::FileDescriptor second(open_exclusively(line.path.c_str()));
  EXPECT_TRUE(second);
}

TEST(ExclusiveLine, WhatIsNotThereSaysSo) {
  EXPECT_EQ(open_exclusively("/dev/no-such-line"), -1);
  EXPECT_EQ(errno, ENOENT);
}

TEST(ArrivalWatch, EachArrivalIsStampedThoughNobodyReads) {
  SerialLine line;
  line.plug();
  const os::FileDescriptor fd(open_exclusively(line.path.c_str()));
  ArrivalWatch watch;
  watch.watch(fd.get());
  std::int64_t last = 0;
  for (int i = 0; i < 3; ++i) {
    const std::int64_t sent = os::monotonic_us();
    line.master.send({1, 2, 3});
    while (watch.last_us() == last && os::monotonic_us() < sent + 10'000'000) {
      std::this_thread::yield();
    }
    last = watch.last_us();
    EXPECT_GE(last, sent);
    EXPECT_LE(last, os::monotonic_us());
  }
}

}  // namespace
