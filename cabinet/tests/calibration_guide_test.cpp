// A simulated hand follows the guide, on a simulated rod with a sensor on a drawn mount.
#include "cabinet/calibration_guide.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>

#include "simulated_person.h"

using namespace cabinet;
using namespace cabinet_test;

namespace {

using Motion = CalibrationRequest::Motion;

struct Session {
  explicit Session(const Mount& mount = {}, const GuideOptions& options = {},
                   std::uint32_t seed = 7)
      : guide(options), rod(mount, seed), person(guide, rod, options) {}
  CalibrationGuide guide;
  SimulatedRod rod;
  Person person;
};

TEST(CalibrationGuide, WhoDoesWhatItAsksIsThroughWithARunThatFits) {
  for (const double push_side : {1.0, -1.0}) {
    for (const double forward_sign : {1.0, -1.0}) {
      Session s({}, {.push_side = push_side, .forward_sign = forward_sign});
      s.person.follow();
      ASSERT_TRUE(s.guide.finished()) << s.guide.step();
      const auto fit = fit_rod(s.guide.run());
      ASSERT_TRUE(fit) << fit.error();
      EXPECT_NEAR(fit->calibration.m[0][0] * 8e3, 1, 0.005);
      EXPECT_NEAR(fit->calibration.m[1][1] * 8e3 * kRodRadius, 1, 0.005);
    }
  }
}

// Compares the fitted calibration with the true motion over ten seconds of play.
TEST(CalibrationGuide, ItsRunsFitAwayTheErrorsOfAMount) {
  std::mt19937 random(4321);
  double slide = 0, angle = 0;
  constexpr int kMounts = 60;
  for (int i = 0; i < kMounts; ++i) {
    const Mount mount = drawn_mount(random, 8);
    Session s(mount, {}, static_cast<std::uint32_t>(100 + i));
    s.person.follow();
    ASSERT_TRUE(s.guide.finished()) << s.guide.step();
    const auto fit = fit_rod(s.guide.run());
    ASSERT_TRUE(fit) << fit.error();
    const PlayErrors e = play(mount, fit->calibration, 10, static_cast<std::uint32_t>(900 + i));
    slide += e.slide * e.slide / kMounts;
    angle += e.angle * e.angle / kMounts;
  }
  std::printf("%.2f mm, %.2f degrees rms\n", std::sqrt(slide) * 1e3, std::sqrt(angle) * 180 / M_PI);
  EXPECT_LE(std::sqrt(slide), 0.5e-3);
  EXPECT_LE(std::sqrt(angle), 0.6 * M_PI / 180);
}

TEST(CalibrationGuide, NeedsNoScaleAndNoOrientationBeforehand) {
  for (const double counts_per_mm : {1.0, 8.0, 39.4, 472.0}) {
    for (const double tilt : {0.0, M_PI / 2, M_PI, -2.0}) {
      Session s({.counts_per_mm = counts_per_mm, .tilt = tilt});
      s.person.follow();
      EXPECT_TRUE(s.guide.finished()) << counts_per_mm << " " << tilt << ": " << s.guide.step();
      EXPECT_TRUE(fit_rod(s.guide.run())) << counts_per_mm << " " << tilt;
    }
  }
}

TEST(CalibrationGuide, AHandThatStopsHalfWayIsNoMark) {
  Session s;
  bool once = true;
  s.person.instead = [&](const CalibrationRequest& asked) {
    if (asked.motion != Motion::push || !std::exchange(once, false)) return false;
    s.person.move(0, 0, 0.5);
    s.person.move(0, 0, 1);
    EXPECT_EQ(s.guide.advice(), GuideAdvice::further);
    EXPECT_NEAR(s.guide.progress(), 0.5, 0.02);
    EXPECT_EQ(s.guide.resting(), 0);
    return true;
  };
  s.person.follow();
  EXPECT_FALSE(once);
  const auto fit = fit_rod(s.guide.run());
  ASSERT_TRUE(fit) << fit.error();
  for (const auto& r : fit->residuals) EXPECT_FALSE(r.outlier);
}

TEST(CalibrationGuide, CountsTheTurnsThatWereMade) {
  for (const int turns : {3, 4, 6, 8}) {
    Session s({.scale = 1.03});
    s.person.turns = turns;
    s.person.follow();
    ASSERT_TRUE(s.guide.finished()) << turns << ": " << s.guide.step();
    const auto fit = fit_rod(s.guide.run());
    ASSERT_TRUE(fit) << turns << ": " << fit.error();
    for (const auto& r : fit->residuals) EXPECT_FALSE(r.outlier) << turns;
  }
}

TEST(CalibrationGuide, SaysThatTheRodWasNotTurnedOrTheWrongWay) {
  Session s;
  int misses = 0;
  s.person.instead = [&](const CalibrationRequest& asked) {
    if (asked.motion == Motion::turn_and_push && s.guide.step() > 10 && misses == 0) {
      s.person.move(s.person.stop(true), s.rod.angle, 0.5);
      s.person.rest();
      EXPECT_EQ(s.guide.advice(), GuideAdvice::turn_more);
      s.person.move(s.rod.slide, s.rod.angle - 1, 0.5);
      s.person.rest();
      EXPECT_EQ(s.guide.advice(), GuideAdvice::wrong_way);
      s.person.move(s.rod.slide, s.rod.angle + 1 + M_PI / 4, 0.5);
      s.person.rest();
      return ++misses > 0;
    }
    if (asked.motion == Motion::turn_back && misses == 1) {
      s.person.move(s.rod.slide, s.rod.angle - 10 * M_PI + 1.5 * M_PI, 2);
      s.person.rest();
      return ++misses > 0;
    }
    return false;
  };
  s.person.follow();
  EXPECT_EQ(misses, 2);
  ASSERT_TRUE(s.guide.finished());
  const auto fit = fit_rod(s.guide.run());
  ASSERT_TRUE(fit) << fit.error();
  EXPECT_NEAR(fit->calibration.m[1][1] * 8e3 * kRodRadius, 1, 0.005);
}

// All eighths were too large: the feet hang down before the guide asks for it.
TEST(CalibrationGuide, FeetThatHangDownAlreadyNeedNoTurn) {
  Session s;
  s.person.eighth_error = 0;
  s.person.instead = [&](const CalibrationRequest& asked) {
    if (asked.motion == Motion::turn_and_push) {
      s.person.move(s.rod.slide, s.rod.angle + 2 * M_PI / 7, 0.5);
      s.person.move(s.person.stop(true), s.rod.angle, 0.6);
      s.person.rest();
      return true;
    }
    if (asked.motion != Motion::turn_feet_down) return false;
    s.person.move(s.rod.slide, s.rod.angle, 3);
    return true;
  };
  s.person.follow();
  EXPECT_TRUE(s.guide.finished()) << s.guide.step();
}

// Many persons and mounts.
TEST(CalibrationGuide, NobodyGetsStuck) {
  for (std::uint32_t i = 0; i < 60; ++i) {
    std::mt19937 random(i);
    const GuideOptions options{.reach = i % 3 == 0 ? 0.06 : i % 3 == 1 ? 0.1 : 0.17};
    Session s(drawn_mount(random, i % 2 == 0 ? 8 : 78.7), options, 1000 + i);
    s.person.follow();
    ASSERT_TRUE(s.guide.finished()) << i << ": " << s.guide.step();
    const auto fit = fit_rod(s.guide.run());
    EXPECT_TRUE(fit) << i << ": " << fit.error();
  }
}

TEST(CalibrationGuide, WaitsForAPersonWhoReadsFirst) {
  Session s;
  s.person.instead = [&](const CalibrationRequest&) {
    const int step = s.guide.step();
    s.person.move(s.rod.slide, s.rod.angle, 3);
    EXPECT_EQ(s.guide.step(), step);
    EXPECT_EQ(s.guide.advice(), GuideAdvice::none);
    return false;
  };
  s.person.follow();
  EXPECT_TRUE(s.guide.finished());
}

TEST(CalibrationGuide, AskedBackItAsksForTheStepBeforeOnceMore) {
  Session s;
  int wrong = 0;
  s.person.instead = [&](const CalibrationRequest&) {
    if (s.guide.step() != 5 || wrong++ > 0) return false;
    const std::size_t marks = s.guide.run().marks.size();
    s.person.move(0, 0, 0.3);
    s.guide.mark();  // in the middle of the table
    EXPECT_GT(s.guide.run().marks.size(), marks);
    EXPECT_EQ(s.guide.step(), 6);
    s.guide.back();
    EXPECT_EQ(s.guide.step(), 5);
    EXPECT_EQ(s.guide.run().marks.size(), marks);
    return true;
  };
  s.person.follow();
  EXPECT_EQ(wrong, 2);
  const auto fit = fit_rod(s.guide.run());
  ASSERT_TRUE(fit) << fit.error();
  for (const auto& r : fit->residuals) EXPECT_FALSE(r.outlier);

  Session early;
  early.guide.mark();
  early.guide.mark();  // no stroke yet
  EXPECT_EQ(early.guide.step(), 1);
  early.guide.back();
  EXPECT_EQ(early.guide.step(), 0);
  EXPECT_TRUE(early.guide.run().marks.empty());
}

TEST(CalibrationGuide, ASensorThatSeesNothingNeverEndsAStep) {
  Session s({.scale = 0});
  s.person.follow();
  EXPECT_EQ(s.guide.step(), 1);
  for (int i = 0; i < 1000; ++i)
    s.guide.add({static_cast<std::int16_t>(i % 2 == 0 ? 1 : -1), 0, 0.005f});
  EXPECT_EQ(s.guide.step(), 1);
}

}  // namespace
