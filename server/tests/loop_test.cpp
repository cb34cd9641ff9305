// The loop on a real clock.
#include "server/loop.h"

#include <gtest/gtest.h>
#include <sched.h>

#include <chrono>
#include <cmath>
#include <string>

#include "lockstep.h"
#include "server/run.h"

namespace server {
namespace {

void silent(LogLevel, const std::string&) {}

LoopOptions ordinary() {
  LoopOptions options;
  options.real_time = false;
  return options;
}

std::int64_t now_us() {
  return std::chrono::duration_cast<std::chrono::microseconds>(
             std::chrono::steady_clock::now().time_since_epoch())
      .count();
}

// A tick that takes 5.5 periods: at least the whole periods within are missed, none is made up for,
// and ticks and misses together are the periods that have passed.
TEST(TickLoop, CountsTheTicksThatAnOverrunMissesAndKeepsItsPhase) {
  TickLoop loop(ordinary(), silent);
  std::int64_t first = 0, last = 0;
  loop.run([&](std::int64_t now, const LoopStats& stats) {
    if (stats.ticks == 0) first = now;
    last = now;
    if (stats.ticks == 20) {
      while (now_us() < now + 5'500) {
      }
    }
    return stats.ticks < 60;
  });
  const LoopStats& stats = loop.stats();
  EXPECT_EQ(stats.ticks, 61u);
  EXPECT_GE(stats.missed, 4u);
  EXPECT_EQ(stats.lateness.count(), 61u);
  EXPECT_GE(stats.cost.max(), 5'500'000);
  const double periods = static_cast<double>(last - first) / 1000.0;
  const double lateness_ms = static_cast<double>(stats.lateness.max()) * 1e-6;
  EXPECT_NEAR(periods, static_cast<double>(60 + stats.missed), 0.1 + lateness_ms);
}

TEST(TickLoop, NeverTicksAheadOfItsClock) {
  TickLoop loop(ordinary(), silent);
  const std::int64_t from = now_us();
  loop.run([&](std::int64_t now, const LoopStats& stats) {
    EXPECT_GE(now, from + static_cast<std::int64_t>(stats.ticks + 1) * 1000);
    return stats.ticks < 100;
  });
}

TEST(TickLoop, SaysWhichRightsItGot) {
  LoopOptions options;
  options.cpu = 0;
  std::string log;
  TickLoop loop(options, [&](LogLevel, const std::string& text) { log += text + "\n"; });
  loop.run([](std::int64_t, const LoopStats&) { return false; });
  EXPECT_NE(log.find("real-time priority"), std::string::npos) << log;
  EXPECT_NE(log.find("memory "), std::string::npos) << log;
  EXPECT_NE(log.find("core 0"), std::string::npos) << log;
  const bool fifo = (::sched_getscheduler(0) & ~SCHED_RESET_ON_FORK) == SCHED_FIFO;
  EXPECT_EQ(fifo, log.find("no real-time priority") == std::string::npos) << log;
  const sched_param none{};
  ::sched_setscheduler(0, SCHED_OTHER, &none);
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
