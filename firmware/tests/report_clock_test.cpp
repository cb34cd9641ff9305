#include "core/report_clock.h"

#include <gtest/gtest.h>

#include <functional>
#include <random>

namespace firmware {
namespace {

// A host that polls every millisecond, and a program that samples when the clock is due.
struct Play {
  ReportClock clock;
  std::uint32_t work_us = 80;
  int late = 0;           // polls of the host without a report ready
  std::uint32_t age = 0;  // of the oldest report taken, from the start of its sample

  // Runs the polls of this many milliseconds. jitter(): deviation of each from its nominal time.
  void run(int tokens, std::uint32_t& token_us, const std::function<int()>& jitter) {
    late = 0;
    age = 0;
    for (int i = 0; i < tokens; ++i) {
      token_us += ReportClock::kPeriodUs;
      const std::uint32_t at = token_us + static_cast<std::uint32_t>(jitter());
      while (static_cast<std::int32_t>(at - clock.next_us()) >= 0) sample();
      if (!ready_ || static_cast<std::int32_t>(at - ready_us_) < 0) {
        ++late;
        continue;
      }
      age = std::max(age, at - began_us_);
      ready_ = false;
      clock.taken(at + ReportClock::kTransferUs);
    }
  }

 private:
  void sample() {
    const std::uint32_t began = clock.next_us();
    clock.sampled(began + work_us);
    if (ready_) return;  // the host has not taken the last one
    began_us_ = began;
    ready_us_ = began + work_us;
    ready_ = true;
  }

  bool ready_ = false;
  std::uint32_t began_us_ = 0, ready_us_ = 0;
};

int none() {
  return 0;
}

TEST(ReportClock, ASampleIsReadyJustBeforeASteadyHostAsks) {
  Play play;
  std::uint32_t token = 700;
  play.run(2000, token, none);
  play.run(1000, token, none);
  EXPECT_EQ(play.late, 0);
  EXPECT_LE(play.age, play.work_us + ReportClock::kMinMarginUs + 2);
}

TEST(ReportClock, TimeMayWrap) {
  Play play;
  std::uint32_t token = 0xFFFFFFFFu - 500'000;
  play.clock.taken(token);
  play.run(2000, token, none);
  EXPECT_LE(play.late, 5);
  EXPECT_LE(play.age, 2 * ReportClock::kPeriodUs);
}

TEST(ReportClock, ADriftingCrystalIsFollowed) {
  Play play;
  std::uint32_t token = 700;
  play.run(1000, token, none);
  int i = 0;
  play.run(5000, token, [&] { return ++i % 10 == 0 ? static_cast<int>(token += 1) * 0 : 0; });
  EXPECT_EQ(play.late, 0);
}

TEST(ReportClock, WorkThatTakesLongerIsGivenTime) {
  Play play;
  std::uint32_t token = 700;
  play.run(1000, token, none);
  play.work_us = 220;
  play.run(50, token, none);
  EXPECT_LE(play.late, 3);
  play.run(1000, token, none);
  EXPECT_EQ(play.late, 0);
  EXPECT_LE(play.age, 220u + 3 * ReportClock::kMinMarginUs);
}

TEST(ReportClock, AHostThatIsEarlyWidensTheMarginAndCalmNarrowsItAgain) {
  Play play;
  std::uint32_t token = 700;
  std::mt19937 random(61);
  play.run(1000, token, none);
  play.run(2000, token, [&] { return static_cast<int>(random() % 61) - 30; });
  EXPECT_GE(play.clock.margin_us(), 50);
  play.run(2000, token, [&] { return static_cast<int>(random() % 61) - 30; });
  EXPECT_LE(play.late, 10);
  EXPECT_LE(play.clock.margin_us(), ReportClock::kMaxMarginUs);
  play.run(5000, token, none);
  EXPECT_EQ(play.clock.margin_us(), ReportClock::kMinMarginUs);
}

TEST(ReportClock, WithoutAHostSamplesGoOnEachMillisecond) {
  ReportClock clock;
  std::uint32_t now = 12'345;
  int samples = 0;
  for (; now < 112'345; ++now) {
    if (!clock.due(now)) continue;
    clock.sampled(now + 80);
    ++samples;
  }
  EXPECT_NEAR(samples, 100, 2);
}

}  // namespace
}  // namespace firmware
