// The rods that the computer plays because no hand drives them: RodDesk alone, in simulated time.
#include <gtest/gtest.h>
#include <sys/socket.h>
#include <unistd.h>

#include "cabinet/device_source.h"
#include "rod_desk.h"
#include "seats.h"
#include "wire/device_frame.h"

namespace server {
namespace {

class Absence : public testing::Test {
 protected:
  static constexpr std::int64_t kStepUs = 100'000;

  Absence() : match(*foosball::Match::create({})), desk({}, {}, false, {}, match.view()) {}
  ~Absence() override {
    if (controller >= 0) ::close(controller);
  }

  struct Hand {
    std::uint32_t client = 0;
    bool sends = true, moves = true;
    std::uint32_t sequence = 0;
  };
  void sit(std::uint32_t client, RodSet rods) {
    ASSERT_NE(desk.seat(client, rods, now), nullptr);
    hands.push_back({.client = client});
  }
  Hand& hand(std::uint32_t client) { return *std::ranges::find(hands, client, &Hand::client); }

  // A cabinet's controller with eight rods.
  void plug_in() {
    std::array<int, 2> ends{-1, -1};
    ASSERT_EQ(::socketpair(AF_UNIX, SOCK_SEQPACKET | SOCK_CLOEXEC, 0, ends.data()), 0);
    controller = ends[0];
    cabinet::DeviceOptions options;
    options.framing = cabinet::DeviceFraming::report;
    desk.add_device(std::make_unique<cabinet::DeviceSource>(
        options, [pc_end = ends[1]]() mutable { return std::exchange(pc_end, -1); }));
  }
  void report() {
    frame.present = present;
    ++frame.sequence;
    frame.time_us += static_cast<std::uint32_t>(kStepUs);
    for (int rod = 0; rod < 8; ++rod) {
      if ((moved_rods >> rod & 1) != 0)
        frame.slide[rod] = static_cast<std::uint16_t>(frame.slide[rod] + (there ? -80 : 80));
    }
    std::array<std::uint8_t, wire::kDeviceReportBytes> bytes{};
    wire::encode_device_frame(frame, bytes.data());
    ::send(controller, bytes.data(), bytes.size(), MSG_NOSIGNAL | MSG_DONTWAIT);
  }

  // Advances time. Sending sources send; moving ones oscillate by 10 mm.
  void pass(std::int64_t us) {
    for (; us > 0; us -= kStepUs) {
      now += kStepUs;
      there = !there;
      if (controller >= 0 && reports) report();
      for (Hand& hand : hands) {
        RemoteSource* source = desk.remote(hand.client);
        if (source == nullptr || !hand.sends) continue;
        wire::InputDatagram in;
        in.sequence = ++hand.sequence;
        for (auto& rod : in.rods) rod = {true, hand.moves && there ? 0.01f : 0.0f, 0.0, 0.0f, 0.0f};
        ASSERT_TRUE(source->accept(in, now));
      }
      desk.watch_absences(in_match, in_play, now);
      desk.poll(now);
    }
  }
  // The driver of a team's rods: none, cabinet, client, Computer, mixed.
  char driver(int team) {
    std::string who;
    for (const int rod : foosball::rods_of_team(foosball::table_spec({}), team))
      who += "-kcCr"[static_cast<int>(desk.driver(rod))];
    return who.find_first_not_of(who[0]) == std::string::npos ? who[0] : '?';
  }

  foosball::Match match;
  RodDesk desk;
  std::vector<Hand> hands;
  int controller = -1;
  bool reports = true;
  std::uint8_t moved_rods = 0xFF, present = 0xFF;
  wire::DeviceFrame frame{};
  std::int64_t now = 1'000'000;
  bool there = false, in_match = true, in_play = true;
  const RodSet team0 = rods_of_team({}, 0), team1 = rods_of_team({}, 1);
};

constexpr std::int64_t kIdle = RodDesk::kIdleUs, kStandIn = RodDesk::kStandInAfterUs;
constexpr std::int64_t kMoment = 500'000;

TEST_F(Absence, AnIdleClientIsReplacedAndHasItsRodsBackAtItsFirstMovement) {
  sit(1, team0);
  sit(2, team1);
  pass(kMoment);
  hand(1).moves = false;
  pass(kIdle - kMoment);
  EXPECT_EQ(driver(0), 'c') << "who waits for the ball is not idle";
  pass(2 * kMoment);
  EXPECT_EQ(driver(0), 'C');
  EXPECT_EQ(driver(1), 'c');
  hand(1).moves = true;
  pass(2 * kStepUs);
  EXPECT_EQ(driver(0), 'c');
}

TEST_F(Absence, ATeamMateWhoMovesDoesNotPlayTheRodsOfOneWhoDoesNot) {
  const RodSet goalie = RodSet(team0 & -team0);
  sit(1, goalie);
  sit(2, RodSet(team0 & ~goalie));
  pass(kMoment);
  hand(1).moves = false;
  pass(kIdle + kMoment);
  EXPECT_EQ(desk.stand_ins(), goalie);
}

TEST_F(Absence, TimeInWhichThereIsNothingToDoIsNoIdleness) {
  sit(1, team0);
  sit(2, team1);
  pass(kMoment);
  hand(1).moves = false;
  in_play = false;  // a pause, a time-out, a ceremony
  pass(3 * kIdle);
  in_play = true;
  pass(kIdle - kMoment);
  EXPECT_EQ(driver(0), 'c');
  in_match = in_play = false;
  pass(kMoment);
  in_match = in_play = true;
  pass(kIdle - kMoment);
  EXPECT_EQ(driver(0), 'c') << "another match";
}

TEST_F(Absence, NobodyIsReplacedWhereAllAreIdle) {
  sit(1, team0);
  sit(2, team1);
  pass(kMoment);
  hand(1).moves = hand(2).moves = false;
  pass(2 * kIdle);
  EXPECT_EQ(desk.stand_ins(), 0) << "the rule for idle ones ends it";
  hand(2).moves = true;
  pass(2 * kStepUs);
  EXPECT_EQ(driver(0), 'C') << "somebody is back, and has an opponent";
}

TEST_F(Absence, OfACabinetTheSideThatNobodyMovesIsReplacedUntilItsRodsMove) {
  plug_in();
  pass(kMoment);
  ASSERT_EQ(driver(0), 'k');
  moved_rods = team0;
  pass(kIdle + kMoment);
  EXPECT_EQ(driver(0), 'k');
  EXPECT_EQ(driver(1), 'C');
  moved_rods = 0xFF;
  pass(3 * kStepUs);
  EXPECT_EQ(driver(1), 'k');
}

TEST_F(Absence, AnUnpluggedCabinetIsReplacedForWhoPlaysOnAndForNobodyElse) {
  present = team0;
  plug_in();
  sit(2, team1);
  pass(kMoment);
  ASSERT_EQ(driver(0), 'k');
  reports = false;
  pass(kStandIn - kMoment);
  EXPECT_EQ(driver(0), 'k') << "it holds";
  pass(2 * kMoment);
  EXPECT_EQ(driver(0), 'C');
  EXPECT_EQ(driver(1), 'c');
  reports = true;
  pass(3 * kStepUs);
  EXPECT_EQ(driver(0), 'k');
  reports = hand(2).sends = false;
  pass(kStandIn + kMoment);
  EXPECT_EQ(desk.stand_ins(), 0) << "nobody is there: a cabinet that is not is nobody";
}

TEST_F(Absence, RodsThatACabinetMovesStayItsOwnWhateverBecomesOfAClientWhoHasThemToo) {
  plug_in();
  sit(1, team0);
  pass(kMoment);
  ASSERT_EQ(driver(0), 'k');
  hand(1).sends = false;
  pass(kStandIn + kMoment);
  EXPECT_EQ(driver(0), 'k');
  desk.leave(1, now);
  pass(RodDesk::kOfferUs + kMoment);
  EXPECT_EQ(driver(0), 'k');
  EXPECT_EQ(desk.stand_ins(), 0);
  EXPECT_EQ(desk.offered(), 0);
}

}  // namespace
}  // namespace server
