// Assignment of rods, votes, and floods of connections.
#include "seats.h"
#include "cabinet/device_source.h"

#include <gtest/gtest.h>
#include <sys/socket.h>
#include <unistd.h>

#include <bit>
#include <utility>

#include "computer_source.h"
#include "door.h"
#include "rod_desk.h"
#include "votes.h"
#include "wire/device_frame.h"

namespace server {
namespace {

using GrantKind = Seats::Grant::Kind;
constexpr auto kLayout = foosball::Layout::tournament;

Seat seat_of(std::uint32_t client, std::uint8_t team, RodSet rods) {
  Seat seat;
  seat.client = client;
  seat.ticket = 1000 + client;
  seat.team = team;
  seat.rods = rods;
  return seat;
}

struct SeatsTest : testing::Test {
  const RodSet all0 = rods_of_team(kLayout, 0), all1 = rods_of_team(kLayout, 1);
  RodSet first_of(RodSet rods) const { return RodSet(rods & -rods); }
  Seats seats{kLayout, false};
};

TEST_F(SeatsTest, TheTwoTeamsShareAllRods) {
  EXPECT_EQ(all0 & all1, 0);
  EXPECT_EQ(all0 | all1, 0xFF);
  EXPECT_EQ(rods_of_team(kLayout, wire::kWatchOnly), 0);
}

TEST_F(SeatsTest, WithoutAWordOfRodsOneGetsAllThatAreFree) {
  EXPECT_EQ(seats.grant(0, 0, 0, false).rods, all0);
  const RodSet one = first_of(all0);
  seats.add(seat_of(1, 0, one));
  EXPECT_EQ(seats.grant(0, 0, 0, false).rods, all0 & ~one);
  seats.add(seat_of(2, 0, RodSet(all0 & ~one)));
  EXPECT_EQ(seats.grant(0, 0, 0, false).kind, GrantKind::taken);
  EXPECT_EQ(seats.grant(1, 0, 0, false).rods, all1);
}

// Every partition of a team between two clients, and of both teams between up to eight.
TEST_F(SeatsTest, AnySplitIsPossibleAndNoRodIsEverTwoPlayers) {
  for (unsigned part = 1; part < 256; ++part) {
    const RodSet mine = RodSet(part & all0), theirs = RodSet(all0 & ~mine);
    if (mine == 0 || theirs == 0) continue;
    Seats table(kLayout, false);
    ASSERT_EQ(table.grant(0, mine, 0, false).kind, GrantKind::granted);
    table.add(seat_of(1, 0, mine));
    for (unsigned wanted = 1; wanted < 256; ++wanted) {
      const RodSet rods = RodSet(wanted & all0);
      if (rods == 0) continue;
      const auto grant = table.grant(0, rods, 0, false);
      EXPECT_EQ(grant.kind == GrantKind::granted, (rods & mine) == 0);
    }
    EXPECT_EQ(table.grant(0, theirs, 0, false).rods, theirs);
  }
}

TEST_F(SeatsTest, OnesOwnRodsMayBeChangedAndOthersAreNamed) {
  const RodSet one = first_of(all0);
  seats.add(seat_of(1, 0, one));
  seats.add(seat_of(2, 0, first_of(RodSet(all0 & ~one))));
  EXPECT_EQ(seats.grant(0, one, 1, false).kind, GrantKind::granted);
  const auto refused = seats.grant(0, all0, 1, false);
  EXPECT_EQ(refused.kind, GrantKind::taken);
  EXPECT_NE(refused.sentence.text().find("are free"), std::string::npos) << refused.sentence.text();
}

TEST_F(SeatsTest, RodsOfBothTeamsAreForThisMachineUnlessTheHostSaysSo) {
  EXPECT_EQ(seats.grant(0, 0xFF, 0, false).kind, GrantKind::other_team);
  EXPECT_EQ(seats.grant(0, 0xFF, 0, true).rods, 0xFF);
  EXPECT_EQ(Seats(kLayout, true).grant(0, 0xFF, 0, false).rods, 0xFF);
  EXPECT_EQ(seats.grant(wire::kWatchOnly, 1, 0, true).kind, GrantKind::none);
}

TEST_F(SeatsTest, AreCountedByMachineAndByNetwork) {
  std::uint32_t client = 0;
  for (const char* host : {"2001:db8::1", "2001:db8::1", "2001:db8::2", "fe80::1", "192.0.2.1"}) {
    Seat seat = seat_of(++client, wire::kWatchOnly, 0);
    seat.peer = *os::parse_address(host, 1);
    seats.add(seat);
  }
  const auto peer = [](const char* host) { return *os::parse_address(host, 2); };
  EXPECT_EQ(seats.of_machine(peer("2001:db8::1")), 2);
  EXPECT_EQ(seats.of_network(peer("2001:db8::1")), 3);
  EXPECT_EQ(seats.of_network(peer("fe80::2")), 0);
  EXPECT_EQ(seats.of_machine(peer("192.0.2.2")), 0);
}

// A seat with a requested name that has not been assigned one yet.
Seat asks_for(const std::string& name, const std::string& owner) {
  Seat seat;
  seat.wanted_name = name;
  seat.owner = owner;
  return seat;
}

// Results and ratings use names as keys: two people who choose one name get two.
TEST_F(SeatsTest, NoTwoPeopleHaveOneName) {
  const Seat near = asks_for("player", "near"), far = asks_for("player", "far");
  EXPECT_EQ(seats.name_for(near, 0), "player");
  Seat first = seat_of(1, 0, all0);
  first.name = first.wanted_name = "player";
  first.owner = "near";
  seats.add(first);
  EXPECT_EQ(seats.name_for(near, 0), "player") << "the same one, at another window";
  EXPECT_EQ(seats.name_for(near, 1), "player (2)") << "nobody plays against himself";
  EXPECT_EQ(seats.name_for(far, 0), "player (2)");
  Seat second = seat_of(2, 1, all1);
  second.wanted_name = "player";
  second.name = "player (2)";
  second.owner = "far";
  seats.add(second);
  EXPECT_EQ(seats.name_for(far, 0), "player (3)");
  EXPECT_EQ(seats.name_for(first, 1), "player") << "who changes sides keeps it where it is free";
  seats.remove(1);
  EXPECT_EQ(seats.name_for(second, 0), "player (2)") << "nor is he the one who has left";
  for (const std::string name : {"computer 5", "cabinet", "nobody"})
    EXPECT_EQ(seats.name_for(asks_for(name, "far"), 0), name + " (1)")
        << "stands for no person in results";
  EXPECT_EQ(seats.name_for(asks_for("computerfan", "far"), 0), "computerfan");
}

TEST_F(SeatsTest, ANameWithANumberBehindItIsNoLongerThanANameMayBeAndHasWholeLetters) {
  std::string longest;
  while (longest.size() + 3 <= wire::kMaxName) longest += "\u20ac";  // three bytes
  Seat first = seat_of(1, 0, all0);
  first.name = longest;
  first.owner = "near";
  seats.add(first);
  const std::string name = seats.name_for(asks_for(longest, "far"), 0);
  EXPECT_LE(name.size(), wire::kMaxName);
  ASSERT_TRUE(name.ends_with(" (2)"));
  EXPECT_EQ((name.size() - 4) % 3, 0u);
}

TEST_F(SeatsTest, ATicketFindsItsSeatAndZeroNone) {
  seats.add(seat_of(1, 0, all0));
  EXPECT_EQ(seats.find_ticket(1001)->client, 1u);
  EXPECT_EQ(seats.find_ticket(1002), nullptr);
  EXPECT_EQ(seats.find_ticket(0), nullptr);
  EXPECT_EQ(to_text(RodSet(0b1011)), "1, 2 and 4");
}

using Voters = std::vector<std::string>;

TEST(Votes, MoreThanHalfOfThoseWhoPlayNowDecide) {
  const foosball::Command restart{foosball::Command::Kind::restart, 0, 0};
  const Voters one{"a"}, two{"a", "b"}, three{"a", "b", "c"}, four{"a", "b", "c", "d"};
  EXPECT_TRUE(Votes().cast("a", restart, one, 0).passed());
  Votes votes;
  EXPECT_FALSE(votes.cast("a", restart, two, 0).passed());
  EXPECT_FALSE(votes.cast("a", restart, two, 1).passed()) << "one vote each";
  EXPECT_TRUE(votes.cast("b", {foosball::Command::Kind::restart, 1, 0}, two, 2).passed());
  EXPECT_FALSE(votes.any());
  Votes of_four;
  EXPECT_FALSE(of_four.cast("a", restart, four, 0).passed());
  EXPECT_FALSE(of_four.cast("b", restart, four, 0).passed());
  EXPECT_TRUE(of_four.cast("c", restart, four, 0).passed());
  Votes left;
  EXPECT_FALSE(left.cast("x", restart, three, 0).passed()) << "who has left does not count";
  EXPECT_EQ(left.cast("a", restart, three, 0).votes, 1);
}

TEST(Votes, AQuestionIsForgottenInTime) {
  Votes votes;
  const foosball::Command pause{foosball::Command::Kind::pause, 0, 1};
  const Voters two{"a", "b"};
  votes.cast("a", pause, two, 1000);
  foosball::Command over{};
  EXPECT_FALSE(votes.expire(1000 + Votes::kOpenUs - 1, over));
  EXPECT_TRUE(votes.expire(1000 + Votes::kOpenUs, over));
  EXPECT_EQ(over.kind, pause.kind);
  EXPECT_FALSE(votes.cast("b", pause, two, 2 + Votes::kOpenUs + 1000).passed());
}

// --- passwords

constexpr std::int64_t kNow = 1'000'000'000;

os::SocketAddress address(const std::string& text) {
  return *os::parse_address(text, 4242);
}

// Number of attempts of these addresses in a time, at a hundred per second each. Advances time.
int tries(PasswordTries& door, const std::vector<std::string>& from, int seconds) {
  int count = 0;
  for (int second = 0; second < seconds; ++second) {
    for (int i = 0; i < 100; ++i) {
      for (const auto& host : from) {
        count += door.charge(address(host), kNow + 1'000'000 * second) ? 1 : 0;
      }
    }
  }
  return count;
}

TEST(PasswordTries, AreAFewAMachineAndThenSlow) {
  PasswordTries door;
  const int guesses = tries(door, {"192.0.2.1"}, 1000);
  EXPECT_GE(guesses, 100);
  EXPECT_LE(guesses, PasswordTries::kAtOnce + 1000 / 10 + 1);
  EXPECT_TRUE(door.charge(address("192.0.2.2"), kNow + 1'000'000'000)) << "another machine";
}

TEST(PasswordTries, ThatWereRightAreGivenBack) {
  PasswordTries door;
  for (int i = 0; i < 1000; ++i) {
    ASSERT_TRUE(door.charge(address("2001:db8::1"), kNow));
    door.refund(address("2001:db8::1"));
  }
  EXPECT_EQ(tries(door, {"2001:db8::1"}, 1), PasswordTries::kAtOnce) << "and no more than that";
}

TEST(PasswordTries, OfANeighbourLockNobodyOut) {
  PasswordTries door;
  tries(door, {"2001:db8::1", "fe80::1"}, 10);
  EXPECT_TRUE(door.charge(address("2001:db8::2"), kNow + 10'000'000)) << "of the same /64";
  EXPECT_TRUE(door.charge(address("fe80::2"), kNow + 10'000'000)) << "of the same LAN";
}

TEST(PasswordTries, OfAWholeIpv6NetworkAreBounded) {
  PasswordTries door;
  std::vector<std::string> hosts;
  for (int i = 1; i <= 2000; ++i) hosts.push_back("2001:db8::" + std::to_string(i));
  EXPECT_LE(tries(door, hosts, 10), PasswordTries::kNetworkAtOnce + 4 + 1);
  EXPECT_TRUE(door.charge(address("2001:db8:0:1::1"), kNow)) << "other networks have their own";
  EXPECT_TRUE(door.charge(address("192.0.2.1"), kNow)) << "and their machines are remembered";
}

TEST(RateLimits, ManyNamesHaveNoMoreThanOneWhenTheirPlacesAreTaken) {
  constexpr int kAtOnce = 5;
  RateLimits limits(kAtOnce, 10'000'000);
  for (std::size_t i = 0; i < RateLimits::kNames; ++i) limits.take(std::to_string(i), kNow);
  int taken = 0;
  for (int number = 0; number < 100; ++number) {
    const std::string name = "new " + std::to_string(number);
    for (int i = 0; i < 10 && limits.may_take(name, kNow); ++i) limits.take(name, kNow), ++taken;
  }
  EXPECT_EQ(taken, kAtOnce);
}

// --- RodDesk: rods of several clients and the computer

struct DeskTest : testing::Test {
  explicit DeskTest(bool fills = false)
      : match(*foosball::Match::create({})), desk({}, {true, false}, fills, {}, match.view()) {}
  std::string drivers() {
    desk.poll(now += 1000);
    std::string text;
    for (int rod = 0; rod < foosball::kRods; ++rod) {
      text += "-kcCr"[static_cast<int>(desk.driver(rod))];
    }
    return text;
  }
  void receive(std::uint32_t client, RodSet rods) {
    wire::InputDatagram in;
    in.sequence = ++sequence;
    for (auto& rod : in.rods) rod = {true, 0.0f, 0.0, 0.0f, 0.0f};
    RemoteSource* source = desk.seat(client, rods, 0);
    ASSERT_NE(source, nullptr);
    ASSERT_TRUE(source->accept(in, now));
  }
  void expect_no_choice_by_the_computer();
  foosball::Match match;
  RodDesk desk;
  std::int64_t now = 0;
  std::uint32_t sequence = 0;
};
struct FillingDesk : DeskTest {
  FillingDesk() : DeskTest(true) {}
};

TEST_F(DeskTest, TheComputerHasATeamUntilAPersonHasARodOfIt) {
  const RodSet all0 = rods_of_team(foosball::MatchDesc{}.layout, 0);
  const auto of = [&](RodSet rods, char who) {
    std::string text(8, '-');
    for (int rod = 0; rod < 8; ++rod) {
      if (rods >> rod & 1) text[static_cast<std::size_t>(rod)] = who;
    }
    return text;
  };
  drivers();
  EXPECT_EQ(drivers(), of(all0, 'C'));
  const RodSet one = RodSet(all0 & -all0), rest = RodSet(all0 & ~one);
  receive(1, one);
  EXPECT_EQ(drivers(), of(one, 'c')) << "the others of the team stand";
  receive(2, rest);
  EXPECT_EQ(drivers(), of(all0, 'c'));
  desk.seat(1, 0, 0);
  EXPECT_EQ(drivers(), of(rest, 'c'));
  desk.seat(2, 0, 0);
  EXPECT_EQ(drivers(), of(all0, 'C'));
}

TEST_F(FillingDesk, TheComputerFillsATeamIfTheHostSaysSo) {
  const RodSet all0 = rods_of_team(foosball::MatchDesc{}.layout, 0);
  const RodSet one = RodSet(all0 & -all0);
  drivers();
  receive(1, one);
  const std::string who = drivers();
  for (std::size_t rod = 0; rod < 8; ++rod) {
    EXPECT_EQ(who[rod], (one >> rod & 1) ? 'c' : (all0 >> rod & 1) ? 'C' : '-');
  }
}

// Steps the match with the desk's rods; a computer with a full team would have confirmed.
void DeskTest::expect_no_choice_by_the_computer() {
  const std::vector<foosball::Command> push{{foosball::Command::Kind::push, 0, 0}};
  match.step({{}, push});
  ASSERT_EQ(match.view().screen, foosball::Screen::selection);
  const int midfield = foosball::rods_of_team(foosball::table_spec(match.view().layout), 0)[2];
  for (int tick = 0; tick < 5000; ++tick) {
    ASSERT_EQ(drivers()[static_cast<std::size_t>(midfield)], 'C');
    foosball::TickInput input;
    for (int rod = 0; rod < foosball::kRods; ++rod) {
      const cabinet::RodInput& in = desk.rods()[rod];
      input.rods[rod] = {in.slide, in.angle, in.slide_rate, in.angle_rate,
                         in.status == cabinet::RodStatus::live};
    }
    match.step(input);
    ASSERT_FALSE(match.view().confirmed[0]) << "tick " << tick;
  }
}

TEST_F(FillingDesk, TheComputerThatFillsLeavesTheChoiceOfACharacterToThePerson) {
  const RodSet all0 = rods_of_team(foosball::MatchDesc{}.layout, 0);
  receive(1, RodSet(all0 & -all0));
  drivers();
  expect_no_choice_by_the_computer();
}

TEST_F(DeskTest, TheComputerLeavesRodsAndChoiceToACabinetThatHasSomeOfThem) {
  const RodSet all0 = rods_of_team(foosball::MatchDesc{}.layout, 0);
  std::array<int, 2> ends{-1, -1};
  ASSERT_EQ(::socketpair(AF_UNIX, SOCK_SEQPACKET | SOCK_CLOEXEC, 0, ends.data()), 0);
  cabinet::DeviceOptions options;
  options.framing = cabinet::DeviceFraming::report;
  desk.add_device(std::make_unique<cabinet::DeviceSource>(
      options, [fd = ends[1]]() mutable { return std::exchange(fd, -1); }));
  wire::DeviceFrame frame{};
  frame.present = RodSet(all0 & -all0);
  drivers();  // opens the device
  for (int report = 0; report < 3; ++report) {
    ++frame.sequence;
    frame.time_us += 1000;
    std::array<std::uint8_t, wire::kDeviceReportBytes> bytes{};
    wire::encode_device_frame(frame, bytes.data());
    ASSERT_EQ(::send(ends[0], bytes.data(), bytes.size(), MSG_NOSIGNAL), ssize_t{bytes.size()});
    drivers();
  }
  EXPECT_EQ(drivers()[static_cast<std::size_t>(std::countr_zero(all0))], 'k');
  expect_no_choice_by_the_computer();
  ::close(ends[0]);
}

TEST(ComputerSource, HasOnlyTheRodsThatItPlays) {
  foosball::Match match = *foosball::Match::create({});
  ComputerSource source({.team = 1}, match.view());
  for (const RodSet mine : std::initializer_list<RodSet>{0x00, 0xFF, 0xA0, 0x00}) {
    const RodSet team = RodSet(rods_of_team(match.view().layout, 1) & mine);
    source.set_rods(mine);
    source.poll(1000);
    for (int rod = 0; rod < foosball::kRods; ++rod) {
      EXPECT_EQ(source.rods()[rod].status == cabinet::RodStatus::live, (team >> rod & 1) != 0);
    }
  }
}

TEST_F(DeskTest, EightClientsMayHaveARodEach) {
  for (std::uint32_t client = 1; client <= 8; ++client) receive(client, RodSet(1u << (client - 1)));
  EXPECT_EQ(drivers(), "cccccccc");
  EXPECT_EQ(desk.seat(9, 0, 0), nullptr);
  EXPECT_EQ(desk.remote(9), nullptr);
}

}  // namespace
}  // namespace server
