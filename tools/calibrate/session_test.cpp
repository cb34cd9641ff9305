// Calibrates rod after rod with a simulated person and a simulated controller.
#include "session.h"

#include <gtest/gtest.h>

#include <cmath>

#include "simulated_device.h"
#include "simulated_person.h"
#include "text.h"

namespace calibrate {
namespace {

using namespace cabinet_test;

cabinet::GuideOptions options_of(int rod) {
  const auto& spec = foosball::table_spec(foosball::Layout::tournament).rods[rod];
  return {.reach = spec.slide_limit,
          .push_side = foosball::push_sign(spec.team),
          .forward_sign = -foosball::attack_sign(spec.team)};
}

struct Table {
  explicit Table(const SessionOptions& options = {}) : session(options) {}

  // Calibrates one rod with a person who follows an identical guide.
  void calibrate(int rod, const Mount& mount) {
    cabinet::CalibrationGuide guide(options_of(rod));
    SimulatedRod simulated(mount, static_cast<std::uint32_t>(50 + rod));
    Person person(guide, simulated, options_of(rod));
    person.on_counts = [&](const cabinet::CountIncrement& c) { send(rod, c); };
    person.on_start = [&] { session.confirm(); };
    person.follow();
  }
  void send(int rod, const cabinet::CountIncrement& c) {
    // A magnet that slips on its rod: its signal's delay changes each second.
    seen.push_front(c.mark);
    if (seen.size() > 50) seen.pop_back();
    if (loose > 0 && device.sequence % 200 == 0) late = random() % loose;
    const bool mark = late < seen.size() && seen[late];
    device.slide[rod] += c.slide;
    device.spin[rod] += c.spin;
    wire::DeviceFrame frame =
        device.frame(static_cast<std::uint32_t>(std::lround(c.seconds * 1e6f)));
    if (mark) frame.index = static_cast<std::uint8_t>(1 << rod);
    session.update(frame);
  }
  void rest(double seconds) {
    for (int i = 0; i < seconds / 0.005; ++i) send(0, {0, 0, 0.005f});
  }

  Session session;
  SimulatedDevice device;
  unsigned loose = 0;
  std::size_t late = 0;
  std::mt19937 random{8};
  std::deque<bool> seen;
};

TEST(CalibrationSession, LeadsThroughAllRodsAndKeepsWhatTheirSensorsCount) {
  Table table;
  table.rest(0.1);
  std::mt19937 random(99);
  std::array<Mount, cabinet::kRods> mounts;
  for (int rod = 0; rod < cabinet::kRods; ++rod) {
    ASSERT_EQ(table.session.rod(), rod);
    ASSERT_EQ(table.session.state(rod), RodState::guided);
    mounts[rod] = drawn_mount(random, 39.4);
    table.calibrate(rod, mounts[rod]);
    ASSERT_EQ(table.session.state(rod), RodState::fitted) << rod << table.session.problem();
    EXPECT_EQ(table.session.kept(), rod + 1);
    EXPECT_EQ(fit_text(*table.session.fit()).size(), 7u);
    table.session.confirm();
  }
  EXPECT_TRUE(table.session.all_fitted());
  for (int rod = 0; rod < cabinet::kRods; ++rod) {
    const PlayErrors e = play(mounts[rod], table.session.calibration().rods[rod], 10,
                              static_cast<std::uint32_t>(rod));
    EXPECT_LT(e.slide, 1e-3) << rod;
    EXPECT_LT(e.angle, 2 * M_PI / 180) << rod;
  }
}

TEST(CalibrationSession, FindsTheIndexMarkOfARodThatHasOne) {
  for (const bool firm : {true, false}) {
    SessionOptions options;
    options.rods = {2};
    Table table(options);
    Mount mount{.counts_per_mm = 39.4};
    mount.mark = {.angle = 0.6, .width = 0.4};
    mount.mark.slide = -options_of(2).push_side * options_of(2).reach;
    table.loose = firm ? 0 : 40;
    table.calibrate(2, mount);
    ASSERT_TRUE(table.session.all_fitted()) << table.session.problem();
    const auto& index = table.session.calibration().rods[2].index;
    ASSERT_EQ(index.has_value(), firm);
    if (index) {
      EXPECT_NEAR(index->angle, 0.6, 0.03);
    }
    EXPECT_FALSE(table.session.calibration().rods[3].index);
    const std::vector<std::string> words = fit_text(*table.session.fit());
    EXPECT_EQ(words.size(), 8u);
    EXPECT_NE(words[6].find(firm ? "index mark" : "its passes differ"), std::string::npos);
  }
}

TEST(CalibrationSession, RodsThatAreLeftAloneStayAsTheyWere) {
  SessionOptions options;
  options.rods = {2};
  options.start.rods[5].m[0][0] = 1e-4;
  Table table(options);
  table.calibrate(2, {.counts_per_mm = 20});
  EXPECT_TRUE(table.session.all_fitted());
  EXPECT_EQ(table.session.calibration().rods[5].m[0][0], 1e-4);
  EXPECT_NEAR(table.session.calibration().rods[2].m[0][0], 1e-3 / 20, 1e-6);
}

TEST(CalibrationSession, ARunThatDoesNotFitIsRefusedAndBegunAnew) {
  SessionOptions options;
  options.rods = {0};
  Table table(options);
  table.rest(0.01);
  cabinet::CalibrationGuide guide(options_of(0));
  SimulatedRod rod({}, 3);
  Person person(guide, rod, options_of(0));
  int frames = 0;
  // The sensor slips: it loses half of the counts at the ends of some strokes.
  person.on_counts = [&](cabinet::CountIncrement c) {
    if (++frames % 1100 > 700 && guide.step() > 9) c.slide = static_cast<std::int16_t>(c.slide / 2);
    table.send(0, c);
  };
  person.on_start = [&] { table.session.confirm(); };
  person.follow();
  // Where the guide did not detect the end of a step, the person confirms it.
  for (int i = 0; i < 100 && table.session.state(0) == RodState::guided; ++i)
    table.session.confirm();
  ASSERT_EQ(table.session.state(0), RodState::refused);
  EXPECT_EQ(table.session.kept(), 0);
  EXPECT_NE(request_text(table.session).find("The calibration run"), std::string::npos);
  table.session.confirm();
  EXPECT_EQ(table.session.state(0), RodState::guided);
  EXPECT_EQ(table.session.guide().step(), 0);
  table.calibrate(0, {});
  EXPECT_TRUE(table.session.all_fitted()) << table.session.problem();
}

TEST(CalibrationSession, SaysWhichRodMovesAndWhichSensorIsSilent) {
  Table table;
  EXPECT_NE(advice_text(table.session).find("is not connected"), std::string::npos);
  table.session.line_is(cabinet::DeviceState::refused, EBUSY);
  EXPECT_NE(advice_text(table.session).find("Another program"), std::string::npos);
  table.session.line_is(cabinet::DeviceState::garbled, 0);
  EXPECT_NE(advice_text(table.session).find("no valid frames"), std::string::npos);
  table.session.line_is(cabinet::DeviceState::live, 0);
  table.device.present = 0xFE;
  table.rest(0.1);
  EXPECT_NE(advice_text(table.session).find("does not answer"), std::string::npos);
  table.device.present = 0xFF;
  table.rest(0.1);
  EXPECT_EQ(advice_text(table.session), "");
  for (int i = 0; i < 40; ++i) table.send(6, {5, 0, 0.005f});
  EXPECT_NE(advice_text(table.session).find("Rod 7 moves"), std::string::npos);
  table.rest(5);
  EXPECT_EQ(advice_text(table.session), "");
}

// Its counts, clock and sequence restart at 0, which is no motion.
TEST(CalibrationSession, AControllerThatIsRestartedStartsTheRodAgain) {
  for (const bool only_the_sensor : {false, true}) {
    Table table;
    table.session.line_is(cabinet::DeviceState::live, 0);
    table.rest(0.1);
    table.session.confirm();
    for (int i = 0; i < 300; ++i) table.send(0, {40, 0, 0.005f});
    for (int i = 0; i < 300; ++i) table.send(0, {-40, 0, 0.005f});
    EXPECT_EQ(table.session.guide().step(), 1);
    EXPECT_FALSE(table.session.interrupted());
    if (only_the_sensor) {
      table.device.present = 0xFE;
      table.rest(0.1);
      table.device.present = 0xFF;
    } else {
      table.device = SimulatedDevice{};
    }
    table.rest(0.1);
    EXPECT_TRUE(table.session.interrupted());
    EXPECT_EQ(table.session.guide().step(), 0);
    EXPECT_NE(advice_text(table.session).find("start this rod again"), std::string::npos);
    table.session.confirm();
    EXPECT_FALSE(table.session.interrupted());
  }
}

TEST(CalibrationSession, ItsTraceIsOfTheLastSecondsOfThisRod) {
  Table table;
  for (int i = 0; i < 4000; ++i) table.send(0, {1, 0, 0.005f});
  const auto& trace = table.session.trace();
  EXPECT_NEAR(trace.back().seconds - trace.front().seconds, Session::kTraceSeconds, 0.02);
  EXPECT_NEAR(trace.back().slide - trace.front().slide, 2000, 5);
  table.session.next_rod(1);
  EXPECT_TRUE(table.session.trace().empty());
}

}  // namespace
}  // namespace calibrate
