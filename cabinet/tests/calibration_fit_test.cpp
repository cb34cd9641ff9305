// Fits of runs with a simulated sensor on a known mount.
#include "cabinet/calibration_fit.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>

#include "simulated_mount.h"

using namespace cabinet;
using namespace cabinet_test;

namespace {

CalibrationRun good_run(const Mount& mount = {}, const RunDesc& desc = {}) {
  SimulatedRod rod(mount, 7);
  return calibration_run(rod, desc);
}

std::string complaint(const CalibrationRun& run) {
  const auto fit = fit_rod(run);
  return fit ? std::string() : fit.error();
}

class MountErrors : public testing::TestWithParam<double> {};
INSTANTIATE_TEST_SUITE_P(CountsAMillimetre, MountErrors, testing::Values(8.0, 39.37, 78.7));

TEST_P(MountErrors, OfFourDegreesThreePercentAndEccentricityAreFittedAway) {
  std::mt19937 random(1234);
  double slide = 0, angle = 0, worst_slide = 0, worst_angle = 0;
  constexpr int kMounts = 20;
  constexpr double kPlay = 10;  // [s] without a stop that would remove drift
  for (int i = 0; i < kMounts; ++i) {
    const Mount mount = drawn_mount(random, GetParam());
    SimulatedRod rod(mount, static_cast<std::uint32_t>(100 + i));
    const auto fit = fit_rod(calibration_run(rod));
    ASSERT_TRUE(fit.has_value()) << fit.error();
    const PlayErrors e = play(mount, fit->calibration, kPlay, static_cast<std::uint32_t>(900 + i));
    slide += e.slide * e.slide / kMounts;
    angle += e.angle * e.angle / kMounts;
    worst_slide = std::max(worst_slide, e.slide);
    worst_angle = std::max(worst_angle, e.angle);
  }
  std::printf("%.1f counts/mm: %.2f mm, %.2f degrees rms; worst mount %.2f mm, %.2f degrees\n",
              GetParam(), std::sqrt(slide) * 1e3, std::sqrt(angle) * 180 / M_PI, worst_slide * 1e3,
              worst_angle * 180 / M_PI);
  EXPECT_LE(std::sqrt(slide), 0.5e-3);
  EXPECT_LE(std::sqrt(angle), 0.6 * M_PI / 180);
}

TEST(CalibrationFit, ALinearMapLeavesMillimetres) {
  std::mt19937 random(1234);
  const Mount mount = drawn_mount(random, 8);
  SimulatedRod rod(mount, 100);
  const auto fit = fit_rod(calibration_run(rod));
  ASSERT_TRUE(fit.has_value()) << fit.error();
  RodCalibration linear = fit->calibration;
  for (int i = 0; i < 2; ++i) linear.slide_gain[i] = linear.spin_gain[i] = 0;
  const PlayErrors without = play(mount, linear, 20, 1),
                   with = play(mount, fit->calibration, 20, 1);
  EXPECT_GT(without.slide, 3 * with.slide);
  EXPECT_GT(without.angle, 1.5 * with.angle);
}

TEST(CalibrationFit, ReturnsAPerfectMount) {
  const auto fit = fit_rod(good_run({.counts_per_mm = 78.7}, {.stop_error = 0, .angle_error = 0}));
  ASSERT_TRUE(fit.has_value()) << fit.error();
  const auto& c = fit->calibration;
  EXPECT_NEAR(c.m[0][0] * 78.7e3, 1, 3e-4);
  EXPECT_NEAR(c.m[0][1] * 78.7e3, 0, 3e-4);
  EXPECT_NEAR(c.m[1][1] * 78.7e3 * 0.008, 1, 3e-4);
  EXPECT_NEAR(std::hypot(c.slide_gain[0], c.slide_gain[1]), 0, 3e-4);
}

TEST(CalibrationFit, FindsASensorOfAnyOrientation) {
  for (const double tilt : {M_PI / 2, M_PI, -2.0}) {
    const Mount mount{.tilt = tilt, .eccentricity = 1e-4, .towards = 1};
    const auto fit = fit_rod(good_run(mount));
    ASSERT_TRUE(fit.has_value()) << tilt << ": " << fit.error();
    const PlayErrors e = play(mount, fit->calibration, 20, 3);
    EXPECT_LT(e.slide, 0.5e-3) << tilt;
    EXPECT_LT(e.angle, 0.6 * M_PI / 180) << tilt;
  }
}

TEST(CalibrationFit, FindsADeadBand) {
  const Mount mount{.dead_band = 20};
  const auto fit = fit_rod(good_run(mount));
  ASSERT_TRUE(fit.has_value()) << fit.error();
  EXPECT_NEAR(fit->calibration.dead_band, 20, 4);
  RodCalibration without = fit->calibration;
  without.dead_band = 0;
  EXPECT_LT(play(mount, fit->calibration, 10, 3).slide, 0.5 * play(mount, without, 10, 3).slide);
}

// An independent check: fits of many runs with the same mount scatter by the deviations they
// report.
TEST(CalibrationFit, ItsDeviationsAreThoseOfManyRuns) {
  const Mount mount{.tilt = 0.05, .eccentricity = 1e-4, .towards = 2};
  constexpr int kRuns = 30;
  std::array<double, 4> sum{}, squares{}, told{};
  for (int i = 0; i < kRuns; ++i) {
    SimulatedRod rod(mount, static_cast<std::uint32_t>(i));
    const auto fit = fit_rod(calibration_run(rod));
    ASSERT_TRUE(fit.has_value()) << fit.error();
    const std::array<double, 4> values{fit->calibration.m[0][0], fit->calibration.m[1][1],
                                       fit->calibration.slide_gain[0],
                                       fit->calibration.slide_gain[1]};
    const std::array<std::size_t, 4> at{0, 3, 4, 5};
    for (std::size_t k = 0; k < 4; ++k) {
      sum[k] += values[k];
      squares[k] += values[k] * values[k];
      told[k] += fit->deviation[at[k]] / kRuns;
    }
  }
  for (std::size_t k = 0; k < 4; ++k) {
    const double mean = sum[k] / kRuns;
    const double scatter = std::sqrt((squares[k] / kRuns - mean * mean) * kRuns / (kRuns - 1));
    std::printf("number %zu: scatter %.3g, deviation %.3g\n", k, scatter, told[k]);
    EXPECT_LT(scatter, 1.5 * told[k]) << k;
    EXPECT_GT(scatter, told[k] / 4) << k;  // the marks are better than the priors assume
  }
}

TEST(CalibrationFit, AMarkThatWasSetTooEarlyDoesNoHarm) {
  const Mount mount{.tilt = 0.05, .eccentricity = 1e-4, .towards = 2};
  CalibrationRun run = good_run(mount);
  const auto sound = fit_rod(run);
  ASSERT_TRUE(sound.has_value());
  std::size_t wrong = 0;
  for (std::size_t i = 12; wrong == 0; ++i) {
    if (run.marks[i].kind == CalibrationMark::Kind::slide) wrong = i;
  }
  run.marks[wrong].value += 0.015;  // 15 mm before the stop
  const auto fit = fit_rod(run);
  ASSERT_TRUE(fit.has_value()) << fit.error();
  EXPECT_NEAR(fit->calibration.m[0][0] / sound->calibration.m[0][0], 1, 1e-3);
  int outliers = 0;
  for (const auto& r : fit->residuals) outliers += r.outlier ? 1 : 0;
  EXPECT_EQ(outliers, 2);  // the stroke to it, and the one from it
}

TEST(CalibrationFit, RefusesARunThatDoesNotShowWhatItHasTo) {
  EXPECT_NE(complaint({}).find("has 0 marks at the end stops"), std::string::npos);
  EXPECT_NE(complaint(good_run({}, {.eighths = 1})).find("eight times"), std::string::npos)
      << complaint(good_run({}, {.eighths = 1}));
  EXPECT_NE(complaint(good_run({}, {.turns = 0})).find("turn the rod five times"),
            std::string::npos)
      << complaint(good_run({}, {.turns = 0}));

  CalibrationRun one_axis = good_run();
  for (auto& c : one_axis.increments) c.spin = 0;
  EXPECT_NE(complaint(one_axis).find("too few counts of one of the two motions"),
            std::string::npos);
  CalibrationRun same = good_run();
  for (auto& c : same.increments) c.spin = c.slide;
  EXPECT_NE(complaint(same), "");

  CalibrationRun order = good_run();
  std::swap(order.marks[1].at, order.marks[9].at);
  EXPECT_NE(complaint(order).find("out of order"), std::string::npos);
  CalibrationRun late = good_run();
  late.marks.back().at += 1;
  EXPECT_NE(complaint(late).find("out of order or out of the run"), std::string::npos);
  CalibrationRun nan = good_run();
  nan.marks[3].value = std::nan("");
  EXPECT_NE(complaint(nan).find("out of order"), std::string::npos);
}

TEST(CalibrationFit, RefusesASensorThatSlips) {
  CalibrationRun run = good_run();
  std::mt19937 random(5);
  for (auto& c : run.increments) {  // one report in three is lost
    if (random() % 3 == 0) c.slide = c.spin = 0;
  }
  EXPECT_NE(complaint(run).find("calibrate again"), std::string::npos) << complaint(run);
}

}  // namespace
