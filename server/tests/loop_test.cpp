// The loop, on a simulated clock; on the real one where the test is about it.
#include "server/loop.h"

#include <gtest/gtest.h>
#include <sched.h>
#include <sys/mman.h>

#include <algorithm>
#include <cerrno>
#include <string>
#include <thread>
#include <vector>

#include "lockstep.h"
#include "os/clock.h"
#include "server/run.h"

namespace server {
namespace {

void silent(LogLevel, const std::string&) {}

LoopOptions ordinary() {
  LoopOptions options;
  options.real_time = false;
  return options;
}

// Time advances only by the loop's sleep and by the stated duration of a tick.
class ManualClock final : public LoopClock {
 public:
  std::int64_t now_ns() override { return now_ += refuses_ ? 10'000 : 0; }
  int sleep_until(std::int64_t deadline) override {
    if (refuses_) return EINVAL;
    now_ = std::max(now_, deadline);
    return 0;
  }
  void pass(std::int64_t ns) { now_ += ns; }
  void refuse() { refuses_ = true; }

 private:
  bool refuses_ = false;
  std::int64_t now_ = 1'000'000'000'000'123;
};

// A tick that takes 5.5 periods: the four full periods within are missed and not made up for; the
// next tick is half a period late, and the ones after it are in phase again.
TEST(TickLoop, CountsTheTicksThatAnOverrunMissesAndKeepsItsPhase) {
  ManualClock clock;
  const std::int64_t start_us = clock.now_ns() / 1000;
  TickLoop loop(ordinary(), silent, clock);
  std::vector<std::int64_t> at_us;
  loop.run([&](std::int64_t now_us, const LoopStats& stats) {
    at_us.push_back(now_us - start_us);
    clock.pass(stats.ticks == 20 ? 5'500'000 : 40'000);
    return stats.ticks < 60;
  });
  const LoopStats& stats = loop.stats();
  ASSERT_EQ(stats.ticks, 61u);
  EXPECT_EQ(stats.missed, 4u);
  for (std::int64_t i = 0; i < 61; ++i) {
    const std::int64_t expected = i <= 20 ? 1000 * (i + 1) : i == 21 ? 26'500 : 1000 * (i + 5);
    EXPECT_EQ(at_us[static_cast<std::size_t>(i)], expected) << i;
  }
  EXPECT_EQ(stats.lateness.count(), 61u);
  EXPECT_EQ(stats.lateness.max(), 500'000);
  EXPECT_EQ(stats.cost.max(), 5'500'000);
  EXPECT_NEAR(static_cast<double>(stats.cost.quantile(0.9)), 40'000, 40'000.0 / 32);
  EXPECT_DOUBLE_EQ(stats.missed_share(), 4.0 / 65.0);
}

// A kernel that cannot sleep: the loop reports it once, and keeps its pace.
TEST(TickLoop, KeepsItsPaceWhereTheClockCannotBeWaitedFor) {
  ManualClock clock;
  clock.refuse();
  int reported = 0;
  TickLoop loop(
      ordinary(),
      [&](LogLevel level, const std::string&) { reported += level == LogLevel::warning; }, clock);
  const std::int64_t start = clock.now_ns();
  loop.run([&](std::int64_t, const LoopStats& stats) { return stats.ticks < 99; });
  EXPECT_EQ(loop.stats().missed, 0u);
  EXPECT_EQ(reported, 1);
  EXPECT_NEAR(static_cast<double>(clock.now_ns() - start), 100e6, 1e6);
}

// An overrun of less than a period delays the next tick, and misses none.
TEST(TickLoop, CatchesUpAfterAShortOverrun) {
  ManualClock clock;
  TickLoop loop(ordinary(), silent, clock);
  loop.run([&](std::int64_t, const LoopStats& stats) {
    clock.pass(stats.ticks == 3 ? 1'900'000 : 10'000);
    return stats.ticks < 9;
  });
  EXPECT_EQ(loop.stats().missed, 0u);
  EXPECT_EQ(loop.stats().lateness.max(), 900'000);
  EXPECT_NEAR(loop.stats().seconds, 0.010'010, 1e-9);
}

TEST(TickLoop, UnpacedItNeverSleepsAndMissesNothing) {
  ManualClock clock;
  LoopOptions fast = ordinary();
  fast.paced = false;
  TickLoop loop(fast, silent, clock);
  loop.run([&](std::int64_t, const LoopStats& stats) {
    clock.pass(3'000'000);
    return stats.ticks < 9;
  });
  EXPECT_EQ(loop.stats().missed, 0u);
  EXPECT_EQ(loop.stats().lateness.count(), 0u);
  EXPECT_NEAR(loop.stats().seconds, 0.030, 1e-9);
}

TEST(TickLoop, NeverTicksAheadOfTheRealClock) {
  TickLoop loop(ordinary(), silent);
  const std::int64_t from = os::monotonic_us();
  loop.run([&](std::int64_t now, const LoopStats& stats) {
    EXPECT_GE(now, from + static_cast<std::int64_t>(stats.ticks + 1) * 1000);
    return stats.ticks < 100;
  });
}

// On its own thread, so that the rights end with the thread.
TEST(TickLoop, SaysWhichRightsItGot) {
  LoopOptions options;
  options.cpu = 0;
  std::string log;
  bool fifo = false;
  std::thread([&] {
    TickLoop loop(options, [&](LogLevel, const std::string& text) { log += text + "\n"; });
    loop.run([](std::int64_t, const LoopStats&) { return false; });
    fifo = (::sched_getscheduler(0) & ~SCHED_RESET_ON_FORK) == SCHED_FIFO;
  }).join();
  ::munlockall();
  EXPECT_NE(log.find("real-time priority"), std::string::npos) << log;
  EXPECT_NE(log.find("memory "), std::string::npos) << log;
  EXPECT_NE(log.find("core 0"), std::string::npos) << log;
  EXPECT_EQ(fifo, log.find("no real-time priority") == std::string::npos) << log;
}

TEST(Run, EndsAfterItsTicksAndWhenTheLastClientLeaves) {
  LoopOptions fast = ordinary();
  fast.paced = false;
  const std::atomic<bool> stop{false};
  Lockstep timed;
  TickLoop loop(fast, silent);
  EXPECT_EQ(run(*timed, loop, {.ticks = 250}, stop), RunEnd::time_over);
  EXPECT_EQ(timed->counters().ticks, 250u);

  Lockstep visited;
  auto client = std::make_unique<ProbeClient>(visited.port());
  ASSERT_TRUE(client->join());
  visited.tick();
  client.reset();
  TickLoop second(fast, silent);
  EXPECT_EQ(run(*visited, second, {.exit_when_empty = true}, stop), RunEnd::empty);
}

TEST(Run, EndsWhenToldTo) {
  LoopOptions fast = ordinary();
  fast.paced = false;
  const std::atomic<bool> stop{true};
  Lockstep table;
  TickLoop loop(fast, silent);
  EXPECT_EQ(run(*table, loop, {}, stop), RunEnd::stopped);
}

}  // namespace
}  // namespace server
