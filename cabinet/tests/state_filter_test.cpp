#include "state_filter.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>

using namespace cabinet;

namespace {

constexpr RodMotion kCount{1e-4, 1e-3};

// A hand tracked by a sensor that reports every report_us, through frames of 1 ms. The first report
// is at `phase` of the first frame. Positions are counts rounded down.
struct Seen {
  StateFilter filter{kCount};
  std::function<double(double)> angle;  // [rad] as a function of [us]
  std::int64_t report_us, phase_us;
  std::int64_t now_us = 0;
  std::int64_t due_us = phase_us;
  double reported = 0;

  void run_until(std::int64_t end_us) {
    while (now_us < end_us) {
      now_us += 1'000;
      const double before = reported;
      for (; due_us <= now_us; due_us += report_us) {
        reported = std::floor(angle(static_cast<double>(due_us)) / kCount.angle) * kCount.angle;
      }
      filter.update(0, reported - before, now_us);
    }
  }
  double error(std::int64_t after_us = 0) const {
    return reported + filter.at(now_us + after_us).angle -
           angle(static_cast<double>(now_us + after_us));
  }
};

double steadily(double us) {
  return 50e-6 * us;
}

TEST(StateFilter, LearnsThePeriodOfTheReports) {
  for (const std::int64_t period : {1'000, 2'000, 4'000, 5'000, 8'000, 10'000}) {
    Seen seen{.angle = steadily, .report_us = period, .phase_us = 300};
    seen.run_until(600'000);
    EXPECT_EQ(seen.filter.report_us(), static_cast<double>(period));
  }
}

// The error for a steady motion: the unknown time of the report within a frame, a count, and the
// assumed braking.
TEST(StateFilter, GoesOnBetweenReports) {
  for (const std::int64_t phase : {10, 250, 500, 750, 990}) {
    Seen seen{.angle = steadily, .report_us = 5'000, .phase_us = phase};
    seen.run_until(100'000);
    for (int ms = 0; ms < 25; ++ms) {
      seen.run_until(seen.now_us + 1'000);
      EXPECT_NEAR(seen.error(), 0, 50 * 0.6e-3 + kCount.angle + 0.025) << phase;
    }
  }
}

TEST(StateFilter, AReportThatFailsToComeEndsTheMotion) {
  const auto stops = [](double us) { return 50e-6 * std::min(us, 100'400.0); };
  Seen seen{.angle = stops, .report_us = 5'000, .phase_us = 400};
  seen.run_until(100'000);
  seen.run_until(105'000);  // the report of 100400 has arrived; the next is due at 105400
  EXPECT_GT(seen.filter.at(seen.now_us).angle_rate, 40);
  seen.run_until(107'000);
  EXPECT_EQ(seen.filter.at(seen.now_us).angle, 0);
  EXPECT_EQ(seen.filter.at(seen.now_us).angle_rate, 0);
}

TEST(StateFilter, ASensorReadInEachFrameEndsAMotionAtTheNextFrame) {
  const auto stops = [](double us) { return 50e-6 * std::min(us, 100'000.0); };
  Seen seen{.angle = stops, .report_us = 1'000, .phase_us = 0};
  seen.run_until(100'000);
  EXPECT_NEAR(seen.filter.at(seen.now_us).angle_rate, 50, 2);
  seen.run_until(101'000);
  EXPECT_EQ(seen.filter.at(seen.now_us).angle_rate, 0);
  EXPECT_EQ(seen.error(), seen.reported - stops(1e6));
}

// At 12,000 rad/s^2 from 60 rad/s: the apex of the parabola is between two reports.
TEST(StateFilter, AHandThatBrakesIsNotSeenToTurnRound) {
  const auto brakes = [](double us) {
    const double s = std::clamp(us - 90'000, 0.0, 5'000.0) * 1e-6;
    return 60e-6 * std::min(us, 90'000.0) + 60 * s - 6'000 * s * s;
  };
  Seen seen{.angle = brakes, .report_us = 2'000, .phase_us = 500};
  seen.run_until(80'000);
  while (seen.now_us < 110'000) {
    seen.run_until(seen.now_us + 1'000);
    for (std::int64_t later = 0; later <= 20'000; later += 500) {
      const RodAhead ahead = seen.filter.at(seen.now_us + later);
      ASSERT_GE(ahead.angle_rate, 0) << seen.now_us << ' ' << later;
      ASSERT_GE(ahead.angle, 0);
    }
  }
}

// No frame arrives for a long time: the motion ends soon after the missing report.
TEST(StateFilter, WithoutFramesAMotionIsNotPredictedForLong) {
  Seen seen{.angle = steadily, .report_us = 5'000, .phase_us = 400};
  seen.run_until(100'000);
  const double max = 50 * 8e-3;
  EXPECT_LT(seen.filter.at(seen.now_us + 10'000'000).angle, max);
  EXPECT_EQ(seen.filter.at(seen.now_us + 10'000'000).angle_rate, 0);
}

// The time stamps of a mouse are untrusted. Ten reports of one time, in all ways to slide and to
// turn of three numbers.
TEST(StateFilter, ReportsOfOneTimeHaveRates) {
  constexpr int kWays = 3 * 3 * 3 * 3 * 3;
  for (int slides = 0; slides < kWays; ++slides) {
    StateFilter filter(kCount, true);
    for (int k = 0, rest = slides; k < 10; ++k, rest = k == 5 ? slides : rest / 3) {
      filter.update(0.01 * (rest % 3 - 1), 0.05, 5'000'000);
      const RodAhead ahead = filter.at(5'001'000);
      for (const double x : {ahead.slide, ahead.angle, ahead.slide_rate, ahead.angle_rate})
        EXPECT_TRUE(std::isfinite(x)) << slides << ' ' << k;
    }
  }
}

TEST(StateFilter, CountsOfALostSecondAreNoBurstOfSpeed) {
  StateFilter filter(kCount);
  filter.update(0, 0, 1'000);
  filter.update(0, 0, 2'000);
  filter.update(0, 2.0, 1'002'000);
  EXPECT_NEAR(filter.at(1'002'000).angle_rate, 2.0, 0.1);
}

}  // namespace
