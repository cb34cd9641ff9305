#include "rod_tracker.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "simulated_device.h"

using namespace cabinet;
using cabinet_test::kMetresPerCount;
using cabinet_test::SimulatedDevice;

namespace {

constexpr double kRadiansPerCount = kMetresPerCount / 0.008;
constexpr std::int64_t kFrameUs = 4'000;

struct Tracked {
  SimulatedDevice device;
  RodTracker tracker{nominal_calibration(), {}};
  SourceCounters counters;
  std::int64_t now_us = 0;

  bool take(const wire::DeviceFrame& frame, std::int64_t after_us = kFrameUs) {
    now_us += after_us;
    return tracker.accept(frame, now_us, now_us, counters);
  }
  // Pose of the last report, with current rates.
  RodInput rod(int index) const {
    RodInput rod = tracker.rods()[index];
    rod.slide = tracker.measured(index).slide;
    rod.angle = tracker.measured(index).angle;
    return rod;
  }
};

TEST(RodTracker, FollowsAllRodsExactlyThroughWrapsBothWays) {
  Tracked t;
  t.take(t.device.frame());
  for (int i = 0; i < 20'000; ++i) {  // rod r: +-(40 + 5 r) counts per frame, up to 24 wraps
    for (int rod = 0; rod < kRods; ++rod) {
      const int sign = rod % 2 == 0 ? 1 : -1;
      t.device.slide[rod] += sign * (40 + 5 * rod);
      t.device.spin[rod] -= sign * (60 + 3 * rod);
    }
    ASSERT_TRUE(t.take(t.device.frame()));
  }
  for (int rod = 0; rod < kRods; ++rod) {
    const double slide = static_cast<double>(t.device.slide[rod]) * kMetresPerCount;
    const double angle = static_cast<double>(t.device.spin[rod]) * kRadiansPerCount;
    EXPECT_NEAR(t.rod(rod).slide, slide, 1e-9) << rod;  // of 200 m
    EXPECT_NEAR(t.rod(rod).angle, angle, 1e-7) << rod;  // of 20,000 rad
    EXPECT_EQ(t.rod(rod).status, RodStatus::live);
  }
  EXPECT_EQ(t.counters.frames, 20'001u);
  EXPECT_EQ(t.counters.lost + t.counters.stale + t.counters.bad, 0u);
}

TEST(RodTracker, LosesNothingWithLostFramesAndCountsThem) {
  Tracked t;
  t.take(t.device.frame());
  std::uint64_t dropped = 0;
  for (int i = 1; i <= 1'000; ++i) {
    t.device.slide[3] += 31;
    t.device.spin[3] -= 17;
    const auto frame = t.device.frame();
    if (i % 10 != 0) {
      ++dropped;
      continue;
    }
    t.take(frame);
  }
  EXPECT_NEAR(t.rod(3).slide, 31'000 * kMetresPerCount, 1e-9);
  EXPECT_NEAR(t.rod(3).angle, -17'000 * kRadiansPerCount, 1e-9);
  EXPECT_EQ(t.counters.lost, dropped);
}

TEST(RodTracker, DropsStaleAndDuplicateFrames) {
  Tracked t;
  const auto first = t.device.frame();
  t.take(first);
  t.device.slide[0] = 100;
  const auto second = t.device.frame();
  t.device.slide[0] = 200;
  const auto third = t.device.frame();
  EXPECT_TRUE(t.take(third));
  EXPECT_FALSE(t.take(second));
  EXPECT_FALSE(t.take(third));
  EXPECT_FALSE(t.take(first));
  EXPECT_EQ(t.counters.stale, 3u);
  EXPECT_DOUBLE_EQ(t.rod(0).slide, 200 * kMetresPerCount);
  t.device.slide[0] = 300;
  EXPECT_TRUE(t.take(t.device.frame()));
  EXPECT_DOUBLE_EQ(t.rod(0).slide, 300 * kMetresPerCount);
}

TEST(RodTracker, ABlockSentTwiceMovesNothingTwice) {
  Tracked t;
  t.device.time_us = 60'000'000;
  std::vector<wire::DeviceFrame> block;
  for (int i = 0; i < 50; ++i) {
    t.device.slide[0] += 10;
    block.push_back(t.device.frame());
  }
  for (int again = 0; again < 2; ++again) {
    for (const auto& frame : block) t.take(frame);
  }
  t.device.slide[0] += 10;
  EXPECT_TRUE(t.take(t.device.frame()));
  EXPECT_NEAR(t.rod(0).slide, 500 * kMetresPerCount, 1e-12);
  EXPECT_EQ(t.counters.stale, 50u);
}

TEST(RodTracker, FollowsSequenceAndClockAcrossTheirWraps) {
  Tracked t;
  t.device.sequence = 65'530;
  t.device.time_us = 0xFFFF'FFFF - 20'000;
  t.take(t.device.frame());
  for (int i = 0; i < 20; ++i) {
    t.device.slide[7] -= 5;
    ASSERT_TRUE(t.take(t.device.frame()));
  }
  EXPECT_NEAR(t.rod(7).slide, -100 * kMetresPerCount, 1e-12);
  EXPECT_EQ(t.counters.lost + t.counters.stale, 0u);
}

// Uptimes before the restart: short, long, and past half the clock's range, where the step back to
// 0 looks like a step forward.
class Restart : public testing::TestWithParam<std::uint32_t> {};

TEST_P(Restart, ContinuesWithoutAJump) {
  Tracked t;
  t.device.time_us = GetParam();
  t.device.sequence = static_cast<std::uint16_t>(GetParam() / 4'000);
  t.take(t.device.frame());
  t.device.slide[2] = 800;
  t.device.spin[2] = -200;
  t.take(t.device.frame());
  const RodInput before = t.rod(2);
  ASSERT_NEAR(before.slide, 0.1, 1e-12);

  t.device = SimulatedDevice{};
  t.device.time_us = 400'000;
  for (int i = 0; i < 10; ++i) {
    t.take(t.device.frame());
    ASSERT_EQ(t.rod(2).slide, before.slide);
    ASSERT_EQ(t.rod(2).angle, before.angle);
  }
  EXPECT_EQ(t.rod(2).status, RodStatus::live);
  t.device.slide[2] += 80;
  t.take(t.device.frame());
  EXPECT_NEAR(t.rod(2).slide, 0.11, 1e-12);
}

INSTANTIATE_TEST_SUITE_P(AfterUptime, Restart,
                         testing::Values(2'000'000u, 600'000'000u, 2'600'000'000u, 4'200'000'000u));

// The micro-controller ran on unheard. Signed 32-bit differences of its clock: the largest positive
// one, negative ones, and past its wrap one that looks like the next frame's.
class Silence : public testing::TestWithParam<std::int64_t> {};

TEST_P(Silence, IsFollowedByANewRunWithoutAJump) {
  Tracked t;
  t.take(t.device.frame());
  t.device.slide[2] = 800;
  t.take(t.device.frame());
  const double before = t.rod(2).slide;
  t.tracker.hold();

  t.now_us += GetParam();
  t.device.time_us += static_cast<std::uint32_t>(GetParam());
  t.device.sequence = static_cast<std::uint16_t>(t.device.sequence + 1'000);
  t.device.slide[2] += 9'000;
  int accepted = 0;
  for (int i = 0; i < 10; ++i) {
    accepted += t.take(t.device.frame());
    ASSERT_EQ(t.rod(2).slide, before);
  }
  EXPECT_EQ(accepted, 7);  // from the fourth on
  t.device.slide[2] += 80;
  t.take(t.device.frame());
  EXPECT_NEAR(t.rod(2).slide, before + 0.01, 1e-12);
  EXPECT_EQ(t.rod(2).status, RodStatus::live);
}

INSTANTIATE_TEST_SUITE_P(OfMinutes, Silence,
                         testing::Values(35 * 60'000'000LL, 36 * 60'000'000LL, 50 * 60'000'000LL,
                                         71 * 60'000'000LL, (1LL << 32) + 100'000,
                                         100 * 60'000'000LL));

// At each resolution: a motion during a gap that the counts can represent is applied; after a
// longer gap, in which they may have wrapped, nothing moves.
void expect_longest_gap(double counts_per_mm, std::uint32_t trusted_us, std::uint32_t doubted_us) {
  Tracked t;
  t.tracker = RodTracker(nominal_calibration(counts_per_mm), {});
  t.take(t.device.frame());
  t.device.slide[0] = 30'000;
  t.take(t.device.frame(trusted_us));
  const double moved = t.rod(0).slide;
  EXPECT_NEAR(moved, 30 / counts_per_mm, 1e-9) << counts_per_mm;
  t.device.slide[0] = 60'000;
  for (int i = 0; i < 10; ++i) t.take(t.device.frame(i == 0 ? doubted_us : 4'000));
  EXPECT_EQ(t.rod(0).slide, moved) << counts_per_mm;
  t.device.slide[0] += 8;
  t.take(t.device.frame());
  EXPECT_NEAR(t.rod(0).slide, moved + 0.008 / counts_per_mm, 1e-9) << counts_per_mm;
}

TEST(RodTracker, AGapTooLongForTheCountsMovesNothing) {
  expect_longest_gap(8, 1'990'000, 2'010'000);
  expect_longest_gap(39.37, 750'000, 770'000);
  expect_longest_gap(472, 62'000, 64'000);
}

TEST(RodTracker, UndoesATiltedSensor) {
  const double tilt = 0.07;  // [rad] 4 degrees
  Calibration calibration = nominal_calibration();
  auto& m = calibration.rods[4].m;
  m[0][0] = kMetresPerCount * std::cos(tilt);
  m[0][1] = -kMetresPerCount * std::sin(tilt);
  m[1][0] = kRadiansPerCount * std::sin(tilt);
  m[1][1] = kRadiansPerCount * std::cos(tilt);
  Tracked t;
  t.tracker = RodTracker(calibration, {});
  t.take(t.device.frame());
  // 40 mm along the rod and no rotation, as counted by the tilted sensor.
  t.device.slide[4] = std::lround(0.04 * std::cos(tilt) / kMetresPerCount);
  t.device.spin[4] = std::lround(-0.04 * std::sin(tilt) / kMetresPerCount);
  t.take(t.device.frame());
  EXPECT_NEAR(t.rod(4).slide, 0.04, 1e-4);
  EXPECT_NEAR(t.rod(4).angle, 0.0, 0.015);  // a count
}

// An eccentric rod: the sensor counts 4 % more while the feet hang down, and 4 % less while they
// are up. 40 mm each, and half a turn in between.
TEST(RodTracker, UndoesAnEccentricRod) {
  Calibration calibration = nominal_calibration();
  calibration.rods[4].slide_gain[0] = -0.04;
  Tracked t;
  t.tracker = RodTracker(calibration, {});
  t.take(t.device.frame());
  t.device.slide[4] = 333;  // 320 / 0.96
  t.take(t.device.frame());
  EXPECT_NEAR(t.rod(4).slide, 0.04, 1e-4);
  t.device.spin[4] = 201;  // half a turn
  t.take(t.device.frame());
  t.device.slide[4] += 308;  // 320 / 1.04
  t.take(t.device.frame());
  EXPECT_NEAR(t.rod(4).slide, 0.08, 1e-4);
}

TEST(RodTracker, TheEndStopTakesOutDrift) {
  Tracked t;
  std::array<double, kRods> limit{};
  limit[1] = 0.1;
  t.tracker = RodTracker(nominal_calibration(), limit);
  t.take(t.device.frame());
  t.device.slide[1] = 1'000;  // 125 mm: 25 of them are drift
  t.take(t.device.frame());
  EXPECT_DOUBLE_EQ(t.rod(1).slide, 0.1);
  t.device.slide[1] -= 800;
  t.take(t.device.frame());
  EXPECT_NEAR(t.rod(1).slide, 0.0, 1e-12);
}

TEST(RodTracker, APredictionEndsAtTheStop) {
  Tracked t;
  std::array<double, kRods> limit{};
  limit[1] = 0.1;
  t.tracker = RodTracker(nominal_calibration(), limit);
  t.take(t.device.frame());
  for (int report = 0; report < 8; ++report) {
    t.device.slide[1] += 88;  // 11 mm in 4 ms: 88 mm in all
    t.take(t.device.frame());
  }
  EXPECT_NEAR(t.rod(1).slide, 0.088, 1e-12);
  t.tracker.predict(t.now_us + 4'000);  // 104 mm without the stop
  EXPECT_EQ(t.tracker.rods()[1].slide, 0.1);
  EXPECT_EQ(t.tracker.rods()[1].slide_rate, 0);
  t.tracker.predict(t.now_us + 500);
  EXPECT_GT(t.tracker.rods()[1].slide, 0.088);
  EXPECT_GT(t.tracker.rods()[1].slide_rate, 2);
}

TEST(RodTracker, AnUnpluggedMouseHoldsItsRodOnly) {
  Tracked t;
  t.take(t.device.frame());
  t.device.slide[5] = t.device.slide[6] = 80;
  t.take(t.device.frame());
  t.device.present = static_cast<std::uint8_t>(~(1 << 5));
  t.device.slide[5] = 40'000;  // its counter may show anything
  t.device.slide[6] = 160;
  t.take(t.device.frame());
  EXPECT_EQ(t.rod(5).status, RodStatus::held);
  EXPECT_EQ(t.rod(5).slide_rate, 0.0);
  EXPECT_NEAR(t.rod(5).slide, 0.01, 1e-12);
  EXPECT_EQ(t.rod(6).status, RodStatus::live);
  EXPECT_NEAR(t.rod(6).slide, 0.02, 1e-12);

  t.device.present = 0xFF;
  t.device.slide[5] = -500;  // plugged in again, it counts from another value
  t.take(t.device.frame());
  EXPECT_EQ(t.rod(5).status, RodStatus::live);
  EXPECT_NEAR(t.rod(5).slide, 0.01, 1e-12);
  t.device.slide[5] -= 8;
  t.take(t.device.frame());
  EXPECT_NEAR(t.rod(5).slide, 0.009, 1e-12);
}

TEST(RodTracker, ARodNeverHeardOfIsAbsent) {
  Tracked t;
  t.device.present = 0x0F;
  t.take(t.device.frame());
  t.tracker.hold();
  EXPECT_EQ(t.rod(3).status, RodStatus::held);
  EXPECT_EQ(t.rod(4).status, RodStatus::absent);
}

// A steady motion, reported every 5 ms, seen through frames of another period: until the next
// report the rate falls by as much as the assumed braking, and no further.
void expect_steady_rate(std::uint32_t frame_us) {
  Tracked t;
  t.take(t.device.frame(frame_us));
  std::uint32_t reported_us = 0;
  double min = 9, max = 0;
  for (std::uint32_t at = frame_us; at < 1'000'000; at += frame_us) {
    for (; reported_us + 5'000 <= at; reported_us += 5'000) {
      t.device.slide[0] += 40;  // 5 mm in 5 ms: 1 m/s
      t.device.spin[0] -= 80;
    }
    t.take(t.device.frame(frame_us), frame_us);
    if (at < 50'000) continue;
    min = std::min(min, t.rod(0).slide_rate);
    max = std::max(max, t.rod(0).slide_rate);
    EXPECT_NEAR(t.rod(0).angle_rate, -250.0, 18);  // 2000 rad/s^2, 5 ms, and the phase error
  }
  EXPECT_GT(min, 0.7) << frame_us;  // 0.2 per period, and twice in the 8 ms of two 4 ms frames
  EXPECT_LT(max, 1.02) << frame_us;
  std::printf("  frames of %u us: a steady 1 m/s is seen as %.3f to %.3f m/s\n", frame_us, min,
              max);
}

TEST(RodTracker, RateOfASteadyMotionStandsThroughFramesOf1And4Ms) {
  expect_steady_rate(1'000);
  expect_steady_rate(4'000);
}

TEST(RodTracker, RateFallsToZeroWhenCountsStop) {
  Tracked t;
  t.take(t.device.frame());
  for (int i = 0; i < 10; ++i) {
    t.device.slide[0] += 40;
    t.take(t.device.frame());
  }
  EXPECT_GT(t.rod(0).slide_rate, 1.0);
  for (int i = 0; i < 4; ++i) t.take(t.device.frame());
  EXPECT_EQ(t.rod(0).slide_rate, 0.0);
  EXPECT_EQ(t.rod(0).status, RodStatus::live);
}

TEST(RodTracker, MotionDuringASilenceIsNoBurstOfSpeed) {
  Tracked t;
  t.take(t.device.frame());
  t.take(t.device.frame());
  t.tracker.hold();
  t.device.slide[0] += 800;  // 100 mm in 100 ms
  t.take(t.device.frame(100'000));
  EXPECT_NEAR(t.rod(0).slide, 0.1, 1e-12);
  EXPECT_NEAR(t.rod(0).slide_rate, 1.0, 1e-9);
}

TEST(RodTracker, AnIncrementThatNoRodCanMakeMovesNothing) {
  for (const int counts : {30'000, -30'000, 2'000, -2'000}) {
    Tracked t;
    t.take(t.device.frame());
    t.device.slide[2] += counts;  // 0.25 m and more in 4 ms
    t.device.slide[3] += 80;
    t.take(t.device.frame());
    EXPECT_EQ(t.rod(2).slide, 0) << counts;
    EXPECT_EQ(t.rod(2).slide_rate, 0) << counts;
    EXPECT_EQ(t.rod(2).status, RodStatus::live);
    EXPECT_NEAR(t.rod(3).slide, 0.01, 1e-12);  // the others continue
    EXPECT_EQ(t.counters.impossible, 1u);
    t.device.slide[2] += 80;  // and so does this one, from there
    t.take(t.device.frame());
    EXPECT_NEAR(t.rod(2).slide, 0.01, 1e-12) << counts;
    t.device.spin[2] += counts;
    t.take(t.device.frame());
    EXPECT_EQ(t.rod(2).angle, 0) << counts;
    EXPECT_EQ(t.counters.impossible, 2u);
  }
}

TEST(RodTracker, HalfOfTheCountsRangeHasNoSign) {
  Tracked t;
  t.take(t.device.frame());
  t.device.slide[2] += 32'768;  // 4.1 m in 1.9 s: possible by hand
  t.take(t.device.frame(1'900'000));
  EXPECT_EQ(t.rod(2).slide, 0);
  EXPECT_EQ(t.counters.impossible, 1u);
}

// At 1 and at 4 ms per frame, with all counts of a 5 ms report in one: 3 m/s and 140 rad/s.
TEST(RodTracker, TheFastestHandsArePossible) {
  for (const std::uint32_t period : {1'000u, 4'000u}) {
    Tracked t;
    t.take(t.device.frame(period));
    for (int report = 1; report <= 10; ++report) {
      t.device.slide[2] += 120;
      t.device.spin[2] += 45;
      t.take(t.device.frame(period));
      t.take(t.device.frame(5'000 - period));
    }
    EXPECT_NEAR(t.rod(2).slide, 0.15, 1e-9);
    EXPECT_NEAR(t.rod(2).angle, 450 * kRadiansPerCount, 1e-9);
    EXPECT_EQ(t.counters.impossible, 0u);
  }
}

TEST(RodTracker, ReportsWhatTheSensorsComplainOf) {
  Tracked t;
  wire::DeviceFrame frame = t.device.frame();
  frame.overflow = 0b101;
  frame.quality = 7;
  t.take(frame);
  EXPECT_EQ(t.counters.overflows, 2u);
  EXPECT_EQ(t.counters.line_errors, 7u);
}

}  // namespace
