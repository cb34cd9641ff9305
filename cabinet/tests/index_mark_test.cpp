// A magnet on a rod and its switch: a calibration finds it, and it corrects the angle in play.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <cstdlib>

#include "cabinet/source_mux.h"
#include "rod_tracker.h"
#include "simulated_device.h"
#include "simulated_person.h"

using namespace cabinet;
using namespace cabinet_test;

namespace {

constexpr double kDegree = M_PI / 180;
constexpr double kReach = 0.1;  // [m] of these rods; the near stop is at -kReach

tl::expected<RodFit, std::string> guided_fit(const Mount& mount, std::uint32_t seed) {
  CalibrationGuide guide;
  SimulatedRod rod(mount, seed);
  Person person(guide, rod, {});
  person.follow();
  return fit_rod(guide.run());
}

TEST(IndexMark, IsFoundByACalibrationWithItsWidthAndItsSwitchsLag) {
  std::mt19937 random(77);
  double squares = 0;
  for (const int report : {1, 5}) {
    for (int i = 0; i < (report == 1 ? 4 : 8); ++i) {
      Mount mount = drawn_mount(random, 39.4);
      mount.report = report;
      mount.mark = drawn_mark(random, -kReach);
      const auto fit = guided_fit(mount, static_cast<std::uint32_t>(300 + i));
      ASSERT_TRUE(fit) << fit.error();
      ASSERT_TRUE(fit->calibration.index) << i << ": " << fit->index_passes << " passes";
      const IndexMark& mark = *fit->calibration.index;
      const double off = std::remainder(mark.angle - mount.mark.angle, 2 * M_PI);
      std::printf("%d ms: off by %.2f degrees (told %.2f), width by %.2f, lag by %.2f of %.2f\n",
                  report, off / kDegree, fit->index_deviation / kDegree,
                  (mark.width - mount.mark.width) / kDegree,
                  (mark.lag - 0.5 * mount.mark.hysteresis) / kDegree,
                  0.5 * mount.mark.hysteresis / kDegree);
      squares += off * off / 12;
      EXPECT_LT(std::abs(off), 4 * fit->index_deviation);
      EXPECT_NEAR(mark.width, mount.mark.width, 2 * kDegree);
      EXPECT_NEAR(mark.lag, 0.5 * mount.mark.hysteresis, 0.8 * kDegree);
    }
  }
  // The feet are marked with an error of 1.5 degrees, 14 times.
  std::printf("%.2f degrees rms\n", std::sqrt(squares) / kDegree);
  EXPECT_LT(std::sqrt(squares), 1 * kDegree);
}

struct Play {
  std::vector<CountIncrement> increments;
  struct Rest {
    std::size_t at;
    RodMotion truth;
  };
  std::vector<Rest> rests;
};

// A hand that plays as in play(); a sixth of its motions end at a stop. Every `calm` seconds it
// pulls the rod to the near stop and swings the men past their mark and back.
Play long_play(const Mount& mount, double seconds, double calm, std::uint32_t seed) {
  SimulatedRod rod(mount, seed);
  Play play;
  double next_calm = calm;
  const auto time = [&] {
    return static_cast<double>(rod.increments.size()) * SimulatedRod::kStep * mount.report;
  };
  while (time() < seconds) {
    if (calm > 0 && time() > next_calm) {
      next_calm += calm;
      const double beside = mount.mark.angle + 0.6 * rod.between(0.9, 1.1);
      rod.move(-kReach - rod.between(0, 2e-4), beside, 0.5);
      rod.move(rod.slide, beside - 1.2, rod.between(0.7, 1.2));
      rod.move(rod.slide, beside, rod.between(0.7, 1.2));
    }
    double to_slide = rod.between(-kReach, kReach);
    const double at = rod.between(0, 6), to_angle = rod.between(-1.5, 1.5);
    if (at < 1) to_slide = std::copysign(kReach + rod.between(0, 2e-4), to_slide);
    rod.move(to_slide, to_angle, rod.between(0.08, 0.4));
    play.rests.push_back({rod.increments.size(), {rod.slide, rod.angle}});
  }
  play.increments = std::move(rod.increments);
  return play;
}

struct Mean {
  double sum = 0;
  int n = 0;
  void add(double value) {
    sum += value;
    ++n;
  }
  double mean() const { return sum / n; }
};

// slide, angle_error: mean error over the last 30 s. angle: change of the mean error from that of
// the second 30 s, since a constant error of the feet's calibration is not drift.
struct Drift {
  double slide, angle, angle_error;  // [m], [rad]
  std::uint64_t disagreements;
};

Drift drift(const Play& play, const RodCalibration& rod, bool stops, int report_ms) {
  Calibration calibration = nominal_calibration();
  calibration.rods[0] = rod;
  std::array<double, kRods> limit{};
  if (stops) limit[0] = kReach;
  RodTracker tracker(calibration, limit);
  SourceCounters counters;
  SimulatedDevice device;
  device.present = 1;
  std::int64_t now_us = 0;
  const auto period = static_cast<std::uint32_t>(1000 * report_ms);
  const auto send = [&](const wire::DeviceFrame& frame) {
    now_us += period;
    tracker.accept(frame, now_us, now_us, counters);
  };
  send(device.frame(period));
  Mean slide, early, late;
  std::size_t done = 0;
  const auto half_minute = static_cast<std::size_t>(30'000 / report_ms);
  for (const Play::Rest& rest : play.rests) {
    for (; done < rest.at; ++done) {
      const CountIncrement& c = play.increments[done];
      device.slide[0] += c.slide;
      device.spin[0] += c.spin;
      wire::DeviceFrame frame = device.frame(period);
      frame.index = c.mark ? 1 : 0;
      send(frame);
    }
    const double angle = tracker.measured(0).angle - rest.truth.angle;
    if (rest.at >= half_minute && rest.at < 2 * half_minute) early.add(angle);
    if (rest.at + half_minute < play.increments.size()) continue;
    late.add(angle);
    slide.add(tracker.measured(0).slide - rest.truth.slide);
  }
  return {slide.mean(), late.mean() - early.mean(), late.mean(), counters.index_disagreements[0]};
}

// Calibrates this many mounts and plays each for this long.
struct Drifts {
  Drift rms{}, worst{};
  void add(const Drift& d, int mounts) {
    const auto one = [&](double Drift::*part) {
      rms.*part = std::hypot(rms.*part, d.*part / std::sqrt(mounts));
      worst.*part = std::max(worst.*part, std::abs(d.*part));
    };
    one(&Drift::slide);
    one(&Drift::angle);
    one(&Drift::angle_error);
  }
  void say(const char* what) const {
    std::printf(
        "%s: drift %.2f mm, %.2f degrees rms, error %.2f degrees; worst %.2f mm, %.2f, %.2f\n",
        what, rms.slide * 1e3, rms.angle / kDegree, rms.angle_error / kDegree, worst.slide * 1e3,
        worst.angle / kDegree, worst.angle_error / kDegree);
  }
};

// SF_MOUNTS=30 gives the results in docs/cabinet.md; it takes a minute.
int mounts_wanted() {
  const char* const mounts = std::getenv("SF_MOUNTS");
  return mounts != nullptr ? std::atoi(mounts) : 2;
}

struct Sensor {
  double counts_per_mm;
  int report;      // [ms]
  double max_rms;  // [rad] of the drift of the angle
};
class Drifting : public testing::TestWithParam<Sensor> {};
INSTANTIATE_TEST_SUITE_P(Of, Drifting,
                         testing::Values(Sensor{78.7, 1, 0.5 * kDegree},
                                         Sensor{8, 5, 0.9 * kDegree}));  // a mouse: one count

// With 30 mounts, at most 0.29 mm and 0.55 degrees at 78.7 counts/mm; without mark and stops 2.3 mm
// and 2.5 degrees rms.
TEST_P(Drifting, IndexMarkAndStopsLeaveNoneAfterTenMinutesOfPlay) {
  const Sensor sensor = GetParam();
  const int mounts = mounts_wanted();
  std::mt19937 random(2026);
  Drifts with, without;
  for (int i = 0; i < mounts; ++i) {
    Mount mount = drawn_mount(random, sensor.counts_per_mm);
    mount.mark = drawn_mark(random, -kReach);
    mount.mark.angle = std::uniform_real_distribution<double>(-1, 1)(random);
    const auto seed = static_cast<std::uint32_t>(10 * i);
    const auto fit = guided_fit(mount, seed);  // 5 ms per frame, which takes a fifth of the time
    ASSERT_TRUE(fit) << fit.error();
    ASSERT_TRUE(fit->calibration.index);
    mount.report = sensor.report;
    mount.loss = 2e-5;
    const Play played = long_play(mount, 600, 20, seed + 1);
    const Drift d = drift(played, fit->calibration, true, mount.report);
    with.add(d, mounts);
    EXPECT_EQ(d.disagreements, 0u);
    RodCalibration blind = fit->calibration;
    blind.index.reset();
    without.add(drift(played, blind, false, mount.report), mounts);
  }
  with.say("mark and stops");
  without.say("neither");
  EXPECT_LE(with.rms.slide, 0.5e-3);
  EXPECT_LE(with.rms.angle, sensor.max_rms);
}

// A rod at its near stop with an exact sensor and its mark at the feet, and a tracker of it. The
// tracker takes the initial angle for feet straight down.
struct Handle {
  static constexpr double kWidth = 22 * kDegree, kLag = 0.75 * kDegree;
  static constexpr double kCount = 1e-3 / 78.7 / kRodRadius;  // [rad]
  static Mount mount() {
    Mount mount{.counts_per_mm = 78.7, .report = 1};
    mount.mark = {.angle = 0, .width = kWidth, .hysteresis = 2 * kLag, .slide = -kReach};
    return mount;
  }
  static Calibration calibration() {
    Calibration calibration = nominal_calibration(78.7);
    calibration.rods[0].index = IndexMark{0, kWidth, kLag};
    return calibration;
  }

  explicit Handle(double begin) {
    rod.slide = -kReach;
    rod.angle = begin;
    send();
  }
  void move(double to_slide, double to_angle, double seconds) {
    const double from_slide = rod.slide, from_angle = rod.angle;
    const int n = static_cast<int>(std::lround(seconds * 1e3));
    for (int i = 1; i <= n; ++i) {
      const double share = static_cast<double>(i) / n;
      rod.step(std::lerp(from_slide, to_slide, share), std::lerp(from_angle, to_angle, share));
      device.slide[0] += rod.increments.back().slide;
      device.spin[0] += rod.increments.back().spin;
      send();
    }
  }
  void turn(double to_angle, double seconds) { move(rod.slide, to_angle, seconds); }
  void send() {
    wire::DeviceFrame frame = device.frame(1'000);
    frame.index = rod.under ? 1 : 0;
    now_us += 1'000;
    tracker.accept(frame, now_us, now_us, counters);
    fastest = std::max(fastest, std::abs(corrected() - last_corrected) / 1e-3);
    last_corrected = corrected();
  }
  // The tracker's change of the angle beyond the counted motion.
  double corrected() const {
    return tracker.measured(0).angle - static_cast<double>(device.spin[0]) * kCount;
  }
  double error() const { return tracker.measured(0).angle - rod.angle; }

  double fastest = 0, last_corrected = 0;  // [rad/s], [rad]
  SimulatedRod rod{mount(), 1};
  SimulatedDevice device;
  RodTracker tracker{calibration(), {}};
  SourceCounters counters;
  std::int64_t now_us = 0;
};

TEST(IndexMark, ItsFirstPassSaysWhereTheFeetAre) {
  for (const double begin : {1.0, -1.0, 2.9, -2.9}) {
    for (const double way : {1.0, -1.0}) {
      Handle h(begin);
      EXPECT_FALSE(h.tracker.rods()[0].angle_known);
      EXPECT_NEAR(h.error(), -begin, 1e-9);
      h.turn(-0.5 * way, 1.5);
      h.turn(0.5 * way, 0.5);
      h.turn(0.5 * way, 1);
      EXPECT_TRUE(h.tracker.rods()[0].angle_known) << begin;
      EXPECT_NEAR(std::remainder(h.error(), 2 * M_PI), 0, 0.3 * kDegree) << begin << " " << way;
      EXPECT_LT(std::abs(h.corrected()), M_PI) << "by the shorter way";
      EXPECT_LT(h.fastest, 7) << "no foot is swung at a ball";
    }
  }
}

TEST(IndexMark, LaterPassesTakeDriftOutTooSlowlyToBeSeen) {
  for (const double lost : {3.0, -3.0, 1.0}) {
    Handle h(0);
    h.turn(0.5, 0.3);
    h.turn(-0.5, 0.5);
    h.turn(0.5, 0.5);
    h.turn(0.5, 1);
    ASSERT_TRUE(h.tracker.rods()[0].angle_known);
    h.device.spin[0] += std::lround(lost * kDegree / Handle::kCount);
    h.turn(0.5, 0.1);
    EXPECT_NEAR(h.error(), lost * kDegree, 0.3 * kDegree);
    h.fastest = 0;
    for (int pass = 0; pass < 6; ++pass) {
      h.turn(pass % 2 == 0 ? -0.5 : 0.5, 0.5);
      h.turn(h.rod.angle, 0.5);
    }
    EXPECT_NEAR(h.error(), 0, 0.3 * kDegree) << lost;
    EXPECT_LT(h.fastest, 0.25) << "15 mm/s at the foot";
    EXPECT_EQ(h.counters.index_disagreements[0], 0u);
  }
}

TEST(IndexMark, AfterWholeTurnsItIsTheSameMark) {
  Handle h(0);
  h.turn(-0.5, 0.3);
  h.turn(0.5, 0.5);
  h.turn(10 * 2 * M_PI - 0.5, 2);  // too fast for the mark to be evaluated
  h.turn(10 * 2 * M_PI + 0.5, 0.5);
  h.turn(h.rod.angle, 1);
  EXPECT_NEAR(h.error(), 0, 0.3 * kDegree);
  EXPECT_EQ(h.counters.index_disagreements[0], 0u);
}

TEST(IndexMark, WhatContradictsByMoreThanAQuarterTurnIsCountedAndChangesNothing) {
  Handle h(0);
  h.turn(-0.5, 0.3);
  h.turn(0.5, 0.5);
  h.turn(0.5, 1);
  h.device.spin[0] += std::lround(100 * kDegree / Handle::kCount);  // or the collar has slipped
  h.turn(0.5, 0.2);
  const double corrected = h.corrected();
  h.turn(-0.5, 0.5);
  h.turn(0.5, 0.5);
  h.turn(0.5, 1);
  EXPECT_EQ(h.counters.index_disagreements[0], 2u);
  EXPECT_NEAR(h.corrected(), corrected, 1e-9);
  EXPECT_EQ(h.counters.index_disagreements[1], 0u);
  h.tracker.calibrate(Handle::calibration());  // another controller is plugged in
  h.send();
  EXPECT_EQ(h.counters.index_disagreements[0], 2u) << "what was counted stays counted";
}

TEST(IndexMark, WhatIsNoSlowPassSaysNothing) {
  const auto says_nothing = [](const char* what, const auto& act) {
    Handle h(0.5);
    act(h);
    h.turn(h.rod.angle, 0.5);
    EXPECT_FALSE(h.tracker.rods()[0].angle_known) << what;
    EXPECT_NEAR(h.corrected(), 0, 1e-9) << what;
  };
  says_nothing("a shot", [](Handle& h) { h.turn(-0.5, 0.02); });
  says_nothing("turned back half way", [](Handle& h) {
    h.turn(0, 0.5);
    h.turn(0.5, 0.5);
  });
  says_nothing("brought under it along the rod", [](Handle& h) {
    h.move(0, 0, 0.5);
    h.move(-kReach, 0, 0.5);
    h.turn(-0.5, 0.5);
  });
  says_nothing("taken away along the rod", [](Handle& h) {
    h.turn(0, 0.5);
    h.move(0, 0, 0.5);
  });
  says_nothing("slid past it", [](Handle& h) {
    h.move(0, 0, 0.5);
    for (int i = 0; i < 3; ++i) {
      h.move(-kReach - 0.01, 0, 0.5);
      h.move(0, 0, 0.5);
    }
  });
  says_nothing("elsewhere along the rod", [](Handle& h) {
    h.move(-kReach + 0.02, 0.5, 0.5);
    h.turn(-0.5, 0.5);
  });
}

TEST(IndexMark, WhoeverWasAwayHasToPassItAgain) {
  Handle h(0);
  h.turn(-0.5, 0.3);
  h.turn(0.5, 0.5);
  h.turn(0.5, 1);
  ASSERT_TRUE(h.tracker.rods()[0].angle_known);
  h.device.present = 0xFE;
  h.send();
  h.rod.angle += 2;  // turned by a hand without being counted
  h.device.present = 0xFF;
  h.turn(h.rod.angle, 0.1);
  EXPECT_FALSE(h.tracker.rods()[0].angle_known);
  EXPECT_NEAR(h.error(), -2, 0.3 * kDegree);
  h.turn(-0.5, 2);
  h.turn(h.rod.angle, 1);
  EXPECT_TRUE(h.tracker.rods()[0].angle_known);
  EXPECT_NEAR(h.error(), 0, 0.3 * kDegree);
}

TEST(IndexMark, ControllersWithoutMarksAndRodsWithoutOneMoveAsTheyAreCounted) {
  Handle h(0);
  h.tracker = RodTracker(nominal_calibration(78.7), {});
  h.send();
  for (int i = 0; i < 4; ++i) h.turn(i % 2 == 0 ? 0.5 : -0.5, 0.5);
  EXPECT_FALSE(h.tracker.rods()[0].angle_known);
  EXPECT_NEAR(h.corrected(), 0, 1e-9);
}

TEST(IndexMark, ARunThatSeesNoneOrOneThatIsLooseHasNone) {
  Mount mount{.counts_per_mm = 39.4};
  const auto none = guided_fit(mount, 3);
  ASSERT_TRUE(none) << none.error();
  EXPECT_FALSE(none->calibration.index);
  EXPECT_EQ(none->index_passes, 0);

  mount.mark = {.angle = 1, .width = 22 * kDegree, .hysteresis = kDegree, .slide = -kReach};
  CalibrationGuide guide;
  SimulatedRod rod(mount, 3);
  Person person(guide, rod, {});
  person.follow();
  CalibrationRun run = guide.run();
  ASSERT_TRUE(fit_rod(run)->calibration.index);
  // It slips on the rod: its passes come later and later.
  std::mt19937 random(8);
  std::size_t late = 0;
  for (std::size_t i = 0; i < run.increments.size(); ++i) {
    if (i % 200 == 0) late = random() % 40;
    run.increments[i].mark = i >= late && guide.run().increments[i - late].mark;
  }
  const auto loose = fit_rod(run);
  ASSERT_TRUE(loose) << loose.error();
  EXPECT_GT(loose->index_passes, 0);
  EXPECT_FALSE(loose->calibration.index);
}

// A handle that a computer player drove meanwhile: its pose is known, not only its motion.
TEST(IndexMark, AnAngleThatIsKnownTakesItsOffsetOut) {
  struct Fixed : InputSource {
    RodInputs all{};
    SourceCounters counted;
    std::string called = "fixed";
    void poll(std::int64_t) override {}
    const RodInputs& rods() const override { return all; }
    const SourceCounters& counters() const override { return counted; }
    const std::string& name() const override { return called; }
  };
  for (const bool known : {false, true}) {
    Fixed cabinet;
    cabinet.all[0] = {.slide = 0.02, .angle = 0.3, .status = RodStatus::live, .angle_known = known};
    std::array<double, kRods> limit{};
    limit.fill(kReach);
    SourceMux mux(limit);
    const int index = mux.add(cabinet, Origin::relative);
    mux.place(0, -0.05, 2 * M_PI - 1);
    mux.assign(0, std::array{index});
    double last = 2 * M_PI - 1;
    for (int ms = 0; ms < 2000; ++ms) {
      mux.poll(1000 * ms);
      EXPECT_LT(std::abs(mux.rods()[0].angle - last), 0.02);
      last = mux.rods()[0].angle;
    }
    EXPECT_NEAR(last, 2 * M_PI + (known ? 0.3 : -1), 1e-3);
    EXPECT_NEAR(mux.rods()[0].slide, -0.05, 1e-9) << "of the slide nothing is known";
  }
}

}  // namespace
