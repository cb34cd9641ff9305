// Short runs of cabinet-bench, and tests that its checks detect errors.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>

#include "calibration.h"
#include "fault_run.h"
#include "hands.h"
#include "match_run.h"
#include "pulse_watch.h"
#include "wire/device_command.h"

namespace cabinet_bench {
namespace {

constexpr double kDegree = 3.14159265358979323846 / 180;

class OnEachController : public testing::TestWithParam<Board> {};
INSTANTIATE_TEST_SUITE_P(Boards, OnEachController, testing::ValuesIn(kBoards),
                         [](const auto& chosen) { return "Board" + name_of(chosen.param); });

struct Expected {
  double slide_rms, angle_rms;  // [mm], [degrees]
  double within;                // fraction of the ticks and rods within 1 mm and 2 degrees
};
// Measured: 1.0 mm, 0.9 degrees, 0.93; 1.0, 1.0, 0.93; 0.06, 0.05, 1. A mouse's reports are 5 ms
// apart.
Expected expected(Board board) {
  return board == Board::rp2040 ? Expected{0.15, 0.15, 0.999} : Expected{2, 2, 0.85};
}
// For half a minute: the play of a few seconds, and so the fraction, depends on each microsecond. A
// person sees the feet to 1.5 degrees, so a mouse's mark is known to 1 degree.
constexpr Expected kCalibrated{2, 2, 0.7};

void expect_played(Board board, const MatchResult& match, const Expected& limits) {
  const Spread slide = spread(match.input.slide), angle = spread(match.input.angle);
  const double within = share_within(match.input, 1e-3, 2 * kDegree);
  std::printf("%s: %.2f mm, %.2f degrees rms, %.1f %% within 1 mm and 2 degrees; %llu pulses\n",
              name_of(board).c_str(), 1e3 * slide.rms, angle.rms / kDegree, 100 * within,
              static_cast<unsigned long long>(match.pulses.pulses));
  EXPECT_GT(match.fastest_slide, 0.5);
  EXPECT_GT(match.fastest_angle, 5);
  EXPECT_LT(1e3 * slide.rms, limits.slide_rms);
  EXPECT_LT(angle.rms / kDegree, limits.angle_rms);
  EXPECT_GT(within, limits.within);
  EXPECT_LE(match.bad, 1u) << "the first may be cut off";
  EXPECT_EQ(match.lost, 0u);
  EXPECT_EQ(match.impossible, 0u);
  EXPECT_GT(match.pulses.pulses, 0u);
  const PulseCounts& pulses = match.pulses;
  EXPECT_EQ(pulses.missing, 0u);
  EXPECT_EQ(match.line_errors, 0u);
  EXPECT_EQ(pulses.stray, 0u);
  EXPECT_EQ(pulses.not_ended, 0u);
  EXPECT_LE(pulses.pulses - pulses.begun - pulses.merged, 1u) << "one may be on its way";
  EXPECT_LE(spread(pulses.free_latency_us).max, 2000);
  // A pulse that comes as another one ends also waits for the bus: 0.8 ms.
  EXPECT_LE(spread(pulses.latency_us).max, 3000);
  EXPECT_GE(2 * pulses.free_latency_us.size(), pulses.latency_us.size());
}

TEST_P(OnEachController, AMatchIsPlayedByHandsOnACabinetAndItsHitsAreFeltAtTheirRods) {
  const Board board = GetParam();
  const auto controller = power_on(board);
  Table table(Mounting::square, Marks::none, usual_counts_per_mm(board), 1);
  for (int ms = 0; ms < 3000; ++ms) table.pass(*controller);
  const MatchResult match =
      play_match(*controller, table, cabinet::nominal_calibration(usual_counts_per_mm(board)),
                 {.max_seconds = 6, .swings = false});
  expect_played(board, match, expected(board));
}

TEST(CabinetEndToEnd, PersonsCalibrateAskewSensorsAndMarksThroughTheFirmwareAndThenPlay) {
  const auto controller = power_on(Board::mega32u4);
  Table table(Mounting::drawn, Marks::drawn, usual_counts_per_mm(Board::mega32u4), 1);
  const CalibrationResult made = calibrate(*controller, table);
  ASSERT_EQ(made.problem, "");
  EXPECT_LT(made.seconds, 150);
  EXPECT_EQ(made.marks, cabinet::kRods);
  const MatchResult match = play_match(*controller, table, made.calibration, {.max_seconds = 30});
  EXPECT_GE(match.marks.slow, 2u * cabinet::kRods) << "there and back, before the match";
  EXPECT_EQ(match.disagreements, 0u);
  expect_played(Board::mega32u4, match, kCalibrated);
}

TEST_P(OnEachController, NothingIsLostInTroublesWithoutBeingCounted) {
  const auto controller = power_on(GetParam());
  const double seconds = GetParam() == Board::rp2040 ? 10 : 40;
  const FaultResult result =
      run_faults(*controller, {.seconds = seconds, .troubles_per_minute = 80, .seed = 3});
  EXPECT_GT(result.troubles.size(), 2u);
  EXPECT_GT(result.totals.losses + result.totals.absences, 0u);
  EXPECT_GT(result.totals.exact, result.totals.frames * cabinet::kRods * 3 / 4);
  EXPECT_EQ(result.violations, std::vector<std::string>{});
}

TEST(Hands, SwingTheirMenPastTheMarksAtTheNearStopAndGiveTheRodsBack) {
  Table table(Mounting::square, Marks::drawn, 8, 3);
  Hands hands({}, table.poses());
  MarkWatch watch;
  std::array<bool, cabinet::kRods> near{}, far{};
  const auto match = foosball::Match::create({.layout = kLayout});
  ASSERT_TRUE(match);
  for (int ms = 0; ms < 4000; ++ms) {
    table.move(hands.move(match->view()));
    watch.moved(table);
    for (std::size_t rod = 0; rod < near.size(); ++rod) {
      const double at = table.poses()[rod].slide / Table::near_stop(rod);
      near[rod] = near[rod] || at > 0.999;
      far[rod] = far[rod] || at < -0.999;
      EXPECT_LT(std::abs(hands.rod(rod).slide_rate), 3) << "a hand";
    }
  }
  for (std::size_t rod = 0; rod < near.size(); ++rod) EXPECT_TRUE(near[rod] && far[rod]) << rod;
  EXPECT_EQ(watch.counts().slow, 2u * cabinet::kRods);
}

// ---- tests of the checks

struct MarkedTable {
  MarkedTable() {
    slide_to(Table::near_stop(0), 100);
    turn_to(-1.5, 1000);
    watch = {};
  }
  void move(const Pose& to, int ms) {
    const Pose from = table.poses()[0];
    for (int i = 1; i <= ms; ++i) {
      PerRod<Pose> poses{};
      const double t = static_cast<double>(i) / ms;
      poses[0] = {std::lerp(from.slide, to.slide, t), std::lerp(from.angle, to.angle, t)};
      table.move(poses);
      watch.moved(table);
    }
  }
  void slide_to(double slide, int ms) { move({slide, table.poses()[0].angle}, ms); }
  void turn_to(double angle, int ms) { move({table.poses()[0].slide, angle}, ms); }
  Table table{Mounting::square, Marks::drawn, 8, 1};
  MarkWatch watch;
};

TEST(MarkWatch, CountsPassesAndWhichOfThemAreSlow) {
  MarkedTable t;
  t.turn_to(1.5, 1000);
  t.turn_to(-1.5, 30);
  EXPECT_EQ(t.watch.counts().passes, 2u);
  EXPECT_EQ(t.watch.counts().slow, 1u);
}

TEST(MarkWatch, DoesNotCountWhatARodThatSlidesOrIsElsewhereDoes) {
  MarkedTable t;
  for (double angle = -0.8; angle < 0.8; angle += 0.1) {  // one of these angles is the mark's
    t.slide_to(0, 200);
    t.turn_to(angle, 200);
    t.slide_to(Table::near_stop(0), 200);
  }
  t.slide_to(0.5 * Table::near_stop(0), 200);
  t.turn_to(-1.5, 1000);
  t.turn_to(1.5, 1000);
  EXPECT_EQ(t.watch.counts().passes, 0u);
}

struct Books {
  // A report each 5 ms and a frame each millisecond, in which some counts never arrive.
  void run(int ms, int per_report, std::uint8_t quality_at_loss = 0, bool loses = false,
           std::uint8_t present = 0xFF) {
    for (int i = 0; i < ms; ++i) {
      now_us += 1000;
      if (now_us % 5000 == 0) {
        told += per_report;
        ledger.told(3, {{now_us, told, 0}});
        if (loses && i < 5) {
          frame.quality = quality_at_loss;
        } else {
          counted = static_cast<std::uint16_t>(counted + per_report);
        }
      }
      frame.slide[3] = counted;
      frame.present = present;
      frame.time_us = static_cast<std::uint32_t>(now_us);
      ++frame.sequence;
      ledger.record(frame, now_us);
      frame.quality = 0;
    }
  }
  Books() {
    for (int rod = 0; rod < cabinet::kRods; ++rod) ledger.told(rod, {{0, 0, 0}});
  }
  Ledger ledger;
  wire::DeviceFrame frame{};
  std::int64_t now_us = 0, told = 0;
  std::uint16_t counted = 0;
};

TEST(Ledger, AgreesWithFramesThatHoldWhatWasToldAlsoOverAWrap) {
  Books books;
  books.run(3000, 250);
  EXPECT_EQ(books.ledger.totals().exact, 3000u * cabinet::kRods);
}

TEST(Ledger, SeesALossThatNoFrameCounts) {
  Books books;
  books.run(1000, 7);
  books.run(3000, 7, 0, true);
  EXPECT_EQ(books.ledger.totals().unexplained, 1u);
  ASSERT_EQ(books.ledger.violations().size(), 1u);
  EXPECT_NE(books.ledger.violations()[0].find("rod 4"), std::string::npos);
}

TEST(Ledger, SeesAnErrorThatIsCountedLongAfterTheLoss) {
  Books books;
  books.run(1000, 7);
  books.run(200, 7, 0, true);
  books.frame.quality = 1;
  books.run(3000, 7);
  EXPECT_EQ(books.ledger.totals().unexplained, 1u);
}

TEST(Ledger, TakesALossThatAFrameCounts) {
  Books books;
  books.run(1000, 7);
  books.run(3000, 7, 1, true);
  EXPECT_EQ(books.ledger.totals().unexplained, 0u);
  EXPECT_EQ(books.ledger.totals().losses, 1u);
}

TEST(Ledger, TakesALossOfASensorThatIsThenSaidToBeAbsent) {
  Books books;
  books.run(1000, 7);
  books.run(300, 7, 0, true);
  books.run(100, 0, 0, false, 0xF7);
  books.run(3000, 7);
  EXPECT_EQ(books.ledger.totals().unexplained, 0u);
  EXPECT_EQ(books.ledger.totals().absences, 1u);
}

std::vector<std::uint8_t> pulse_report(int rod, int amplitude, int ms) {
  wire::DeviceCommand command{};
  command.kind = wire::kPulseCommand;
  command.rod = static_cast<std::uint8_t>(rod);
  command.amplitude = static_cast<std::uint8_t>(amplitude);
  command.duration_ms = static_cast<std::uint16_t>(ms);
  std::vector<std::uint8_t> packet(1 + wire::kDeviceReportBytes);
  wire::encode_device_command(command, packet.data() + 1);
  return packet;
}

struct Motors {
  void command(std::int64_t us, int rod, int amplitude, int ms) {
    watch.commanded(pulse_report(rod, amplitude, ms), cabinet::DeviceFraming::report, us);
  }
  PulseWatch watch;
};

TEST(PulseWatch, FollowsAPulseToItsMotor) {
  Motors motors;
  motors.command(1000, 5, 90, 20);
  motors.watch.written({1400, 5, 90});
  motors.watch.written({21'400, 5, 0});
  motors.watch.passed(100'000);
  EXPECT_EQ(motors.watch.counts().begun, 1u);
  EXPECT_EQ(motors.watch.counts().latency_us, std::vector<float>{400});
  EXPECT_EQ(motors.watch.counts().missing + motors.watch.counts().stray, 0u);
  EXPECT_EQ(motors.watch.counts().not_ended, 0u);
}

TEST(PulseWatch, SeesAPulseAtAnotherMotorOneThatNeverBeginsAndOneWithoutEnd) {
  Motors motors;
  motors.command(1000, 5, 90, 20);
  motors.watch.written({1400, 4, 90});
  motors.watch.passed(100'000);
  EXPECT_EQ(motors.watch.counts().stray, 1u);
  EXPECT_EQ(motors.watch.counts().missing, 1u);
  EXPECT_EQ(motors.watch.counts().not_ended, 1u);
}

}  // namespace
}  // namespace cabinet_bench
