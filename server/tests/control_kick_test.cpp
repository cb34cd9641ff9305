// Removing players from a match, on real sockets. Untrusted loopback addresses simulate remote
// clients.
#include "control_fixture.h"
#include "seats.h"

namespace server {
namespace {

class Kicks : public testing::Test {
 protected:
  Kicks()
      : table([](ServerOptions& o) {
          o.access.trust_this_machine = false;
          o.access.password = "open sesame";
          o.access.host_password = "mine";
          o.limits.seat_kept_us = 30'000'000;
          o.match.rules.attract_seconds = 1.0;
        }) {}

  struct Guest {
    ProbeClient probe;
    std::optional<wire::Welcome> welcome;
    std::uint32_t client() const { return welcome ? welcome->client : 0; }
  };
  // rod < 0: to watch.
  Guest guest(const std::string& from, int rod, wire::Role role = wire::Role::player) {
    Guest g{ProbeClient(table.port(), from), std::nullopt};
    if (!g.probe.prove(role == wire::Role::host ? "mine" : "open sesame", role)) return g;
    wire::Hello hello = g.probe.hello(rod < 0 ? wire::kWatchOnly : team_of(rod));
    hello.name = from;
    hello.rods = rod < 0 ? RodSet{0} : RodSet(1u << rod);
    g.welcome = g.probe.join(hello);
    return g;
  }
  static std::uint8_t team_of(int rod) {
    return (rods_of_team(foosball::MatchDesc{}.layout, 0) >> rod & 1) != 0 ? 0 : 1;
  }
  void vote(Guest& voter, std::uint32_t against) {
    voter.probe.send(wire::Kick{against});
    voter.probe.catch_up();
  }
  void claim(Guest& who, RodSet rods, int team) {
    who.probe.send(wire::Claim{rods, static_cast<std::uint8_t>(team)});
    who.probe.catch_up();
  }
  RodSet rods_of(Guest& who) {
    who.probe.catch_up();
    for (const wire::Seat& seat : who.probe.roster().seats)
      if (seat.client == who.client()) return seat.rods;
    return 0;
  }
  void push(Guest& who, int rod) {
    const std::uint64_t requests = table->counters().control.requests;
    who.probe.send(wire::MatchRequest{number(wire::RequestKind::push), team_of(rod), 0});
    ASSERT_TRUE(table.wait_until([&] { return table->counters().control.requests > requests; }));
    table.tick(5);
  }
  foosball::Screen screen() { return table->match().view().screen; }
  std::uint64_t kicked() { return table->counters().control.kicked; }

  Lockstep table;
};

TEST_F(Kicks, MoreThanHalfOfTheOthersPutAPlayerOutWhoMayWatchAndPlaysTheNextMatch) {
  Guest a = guest("127.0.0.2", 0), b = guest("127.0.0.3", 1), c = guest("127.0.0.4", 2),
        bad = guest("127.0.0.5", 3);
  ASSERT_TRUE(a.welcome && b.welcome && c.welcome && bad.welcome);
  vote(a, bad.client());
  EXPECT_EQ(kicked(), 0u);
  vote(b, bad.client());
  EXPECT_EQ(kicked(), 1u);
  const auto refusal = bad.probe.receive_a<wire::Refusal>();
  ASSERT_TRUE(refusal);
  EXPECT_EQ(refusal->code, Code::not_allowed);
  Guest again{ProbeClient(table.port(), "127.0.0.5"), std::nullopt};
  ASSERT_TRUE(again.probe.prove("open sesame"));
  EXPECT_FALSE(again.probe.resume(*bad.welcome)) << "the ticket is worth nothing";
  EXPECT_FALSE(guest("127.0.0.5", 3).welcome) << "nor does a new seat help";
  Guest watcher = guest("127.0.0.5", -1);
  ASSERT_TRUE(watcher.welcome);
  watcher.probe.send(wire::Claim{RodSet(1u << 3), team_of(3)});
  EXPECT_TRUE(watcher.probe.catch_up());
  for (const wire::Seat& seat : watcher.probe.roster().seats)
    EXPECT_TRUE(seat.client != watcher.client() || seat.rods == 0);
  EXPECT_TRUE(guest("127.0.0.6", 3).welcome) << "somebody else may have the rod";
}

TEST_F(Kicks, OnePersonAtOneAddressDecidesNothingHoweverManyClientsItOpens) {
  Guest a = guest("127.0.0.2", 0), second = guest("127.0.0.2", 1), third = guest("127.0.0.2", 2),
        victim = guest("127.0.0.5", 3);
  ASSERT_TRUE(a.welcome && second.welcome && third.welcome && victim.welcome);
  for (Guest* one : {&a, &second, &third}) vote(*one, victim.client());
  EXPECT_EQ(kicked(), 0u) << "alone against one: that is for the host";
  Guest other = guest("127.0.0.3", 4);
  ASSERT_TRUE(other.welcome);
  for (Guest* one : {&a, &second, &third}) vote(*one, victim.client());
  EXPECT_EQ(kicked(), 0u) << "one machine, one vote";
}

TEST_F(Kicks, TheHostDoesItAloneAndIsNotPutOut) {
  Guest host = guest("127.0.0.2", 0, wire::Role::host), a = guest("127.0.0.3", 1),
        b = guest("127.0.0.4", 2);
  ASSERT_TRUE(host.welcome && a.welcome && b.welcome);
  vote(a, host.client());
  vote(b, host.client());
  EXPECT_EQ(kicked(), 0u);
  vote(host, a.client());
  EXPECT_EQ(kicked(), 1u);
  EXPECT_TRUE(a.probe.receive_a<wire::Refusal>());
}

TEST_F(Kicks, WatchersHaveNoVoteAndAreNotPutOut) {
  Guest a = guest("127.0.0.2", 0), b = guest("127.0.0.3", 1), victim = guest("127.0.0.4", 2),
        watcher = guest("127.0.0.5", -1), other = guest("127.0.0.6", -1);
  ASSERT_TRUE(a.welcome && b.welcome && victim.welcome && watcher.welcome && other.welcome);
  vote(watcher, victim.client());
  vote(other, victim.client());
  EXPECT_EQ(kicked(), 0u);
  vote(a, watcher.client());
  vote(b, watcher.client());
  EXPECT_EQ(kicked(), 0u);
}

TEST_F(Kicks, AVoteAgainstWhoHasJustLeftOrNeverWasDoesNothing) {
  Guest a = guest("127.0.0.2", 0), b = guest("127.0.0.3", 1), c = guest("127.0.0.4", 2);
  ASSERT_TRUE(a.welcome && b.welcome && c.welcome);
  vote(a, c.client());
  c.probe.send_goodbye();
  ASSERT_TRUE(table.wait_until([&] { return table->counters().control.left == 1; }));
  vote(b, c.client());
  vote(b, 999'999);
  EXPECT_EQ(kicked(), 0u);
  EXPECT_TRUE(guest("127.0.0.4", 2).welcome) << "nothing was decided: it may come back";
}

TEST_F(Kicks, AVoteOutlastsAReconnectionWithTheTicketAndANewSeat) {
  Guest a = guest("127.0.0.2", 0), b = guest("127.0.0.3", 1), c = guest("127.0.0.4", 3),
        bad = guest("127.0.0.5", 2);
  ASSERT_TRUE(a.welcome && b.welcome && c.welcome && bad.welcome);
  vote(a, bad.client());
  bad.probe.leave();
  ASSERT_TRUE(table.wait_until([&] { return table->counters().control.lost == 1; }));
  Guest again{ProbeClient(table.port(), "127.0.0.5"), std::nullopt};
  ASSERT_TRUE(again.probe.prove("open sesame"));
  again.welcome = again.probe.resume(*bad.welcome);
  ASSERT_TRUE(again.welcome);
  again.probe.send_goodbye();
  ASSERT_TRUE(table.wait_until([&] { return table->counters().control.left == 1; }));
  Guest anew = guest("127.0.0.5", 2);
  ASSERT_TRUE(anew.welcome);
  ASSERT_NE(anew.client(), bad.client());
  vote(b, anew.client());
  EXPECT_EQ(kicked(), 1u) << "the first vote still counts";
}

TEST_F(Kicks, AVoteIsNotEscapedByComingBackToWatchAndTakingRodsThen) {
  Guest a = guest("127.0.0.2", 0), b = guest("127.0.0.3", 1), c = guest("127.0.0.4", 3),
        bad = guest("127.0.0.5", 2);
  ASSERT_TRUE(a.welcome && b.welcome && c.welcome && bad.welcome);
  vote(a, bad.client());
  bad.probe.send_goodbye();
  ASSERT_TRUE(table.wait_until([&] { return table->counters().control.left == 1; }));
  Guest anew = guest("127.0.0.5", -1);
  ASSERT_TRUE(anew.welcome);
  claim(anew, RodSet(1u << 2), team_of(2));
  EXPECT_EQ(rods_of(anew), RodSet(1u << 2));
  vote(b, anew.client());
  EXPECT_EQ(kicked(), 1u) << "the first vote still counts";
  EXPECT_FALSE(guest("127.0.0.5", 2).welcome);
}

TEST_F(Kicks, AVoteIsNotEscapedByGivingUpTheRods) {
  Guest a = guest("127.0.0.2", 0), b = guest("127.0.0.3", 1), bad = guest("127.0.0.5", 2);
  ASSERT_TRUE(a.welcome && b.welcome && bad.welcome);
  vote(a, bad.client());
  claim(bad, 0, team_of(2));
  vote(b, bad.client());
  EXPECT_EQ(kicked(), 1u);
  EXPECT_TRUE(bad.probe.receive_a<wire::Refusal>());
  EXPECT_FALSE(guest("127.0.0.5", 2).welcome);
}

TEST_F(Kicks, AVoteIsNotEscapedByASecondSeatOfTheMachine) {
  Guest a = guest("127.0.0.2", 0), b = guest("127.0.0.3", 1), bad = guest("127.0.0.5", 2),
        second = guest("127.0.0.5", -1);
  ASSERT_TRUE(a.welcome && b.welcome && bad.welcome && second.welcome);
  vote(a, bad.client());
  claim(bad, 0, team_of(2));
  claim(second, RodSet(1u << 2), team_of(2));
  EXPECT_EQ(rods_of(second), 0) << "the rods would be where the vote is not";
  EXPECT_FALSE(guest("127.0.0.5", 2).welcome);
  Guest innocent = guest("127.0.0.6", 2);
  EXPECT_TRUE(innocent.welcome);
  vote(b, bad.client());
  vote(innocent, bad.client());
  EXPECT_EQ(kicked(), 1u);
}

TEST_F(Kicks, AVoteIsNotEscapedByAnotherAddress) {
  Guest a = guest("127.0.0.2", 0), b = guest("127.0.0.3", 1), bad = guest("127.0.0.5", 2);
  ASSERT_TRUE(a.welcome && b.welcome && bad.welcome);
  vote(a, bad.client());
  Guest moved{ProbeClient(table.port(), "127.0.0.6"), std::nullopt};
  ASSERT_TRUE(moved.probe.prove("open sesame"));
  moved.welcome = moved.probe.resume(*bad.welcome);
  ASSERT_TRUE(moved.welcome);
  vote(b, moved.client());
  EXPECT_EQ(kicked(), 1u);
  EXPECT_FALSE(guest("127.0.0.5", 2).welcome);
  EXPECT_FALSE(guest("127.0.0.6", 2).welcome);
}

TEST_F(Kicks, ANewcomerFromTheAddressIsNotToldToBeTheOneWhoLeft) {
  Guest a = guest("127.0.0.2", 0), b = guest("127.0.0.3", 1), bad = guest("127.0.0.5", 2);
  ASSERT_TRUE(a.welcome && b.welcome && bad.welcome);
  vote(a, bad.client());
  bad.probe.send_goodbye();
  ASSERT_TRUE(table.wait_until([&] { return table->counters().control.left == 1; }));
  ASSERT_TRUE(guest("127.0.0.5", 2).welcome);
  std::string said;
  while (said.find("127.0.0.5 comes from the address of 127.0.0.5, who has left") ==
         std::string::npos) {
    const auto notice = b.probe.receive_a<wire::Notice>();
    ASSERT_TRUE(notice) << said;
    said = notice->text;
  }
}

TEST_F(Kicks, DecidedOnTheLogoItOutlastsAnExhibitionAndEndsWithTheNextMatch) {
  Guest a = guest("127.0.0.2", 0), b = guest("127.0.0.3", 1), c = guest("127.0.0.4", 7),
        bad = guest("127.0.0.5", 2);
  ASSERT_TRUE(a.welcome && b.welcome && c.welcome && bad.welcome);
  ASSERT_NE(team_of(0), team_of(7));
  vote(a, bad.client());
  vote(b, bad.client());
  ASSERT_EQ(kicked(), 1u);
  ASSERT_TRUE(table.tick_until([&] { return table->match().view().attract; }));
  push(a, 0);
  ASSERT_EQ(screen(), foosball::Screen::logo);
  EXPECT_FALSE(guest("127.0.0.5", 2).welcome) << "nobody played";
  push(a, 0);
  ASSERT_EQ(screen(), foosball::Screen::selection);
  push(a, 0);
  push(c, 7);
  ASSERT_TRUE(table.tick_until([&] { return screen() == foosball::Screen::play; }));
  EXPECT_FALSE(guest("127.0.0.5", 2).welcome);
  for (Guest* one : {&a, &b})
    one->probe.send(wire::MatchRequest{number(wire::RequestKind::restart), 0, 0});
  ASSERT_TRUE(table.tick_until([&] { return screen() == foosball::Screen::logo; }));
  EXPECT_TRUE(guest("127.0.0.5", 2).welcome);
}

TEST_F(Kicks, WhoIsAwayIsPutOutTooAndTheSeatIsFree) {
  Guest a = guest("127.0.0.2", 0), b = guest("127.0.0.3", 1), bad = guest("127.0.0.5", 2);
  ASSERT_TRUE(a.welcome && b.welcome && bad.welcome);
  bad.probe.leave();
  ASSERT_TRUE(table.wait_until([&] { return table->counters().control.lost == 1; }));
  vote(a, bad.client());
  vote(b, bad.client());
  EXPECT_EQ(kicked(), 1u);
  Guest again{ProbeClient(table.port(), "127.0.0.5"), std::nullopt};
  ASSERT_TRUE(again.probe.prove("open sesame"));
  EXPECT_FALSE(again.probe.resume(*bad.welcome));
  EXPECT_TRUE(guest("127.0.0.6", 2).welcome);
}

TEST_F(Kicks, AFloodOfVotesIsOneVoteAndTheTableHearsLittleOfIt) {
  Guest a = guest("127.0.0.2", 0), b = guest("127.0.0.3", 1), c = guest("127.0.0.4", 2),
        d = guest("127.0.0.5", 3);
  ASSERT_TRUE(a.welcome && b.welcome && c.welcome && d.welcome);
  for (int i = 0; i < 500; ++i) a.probe.send(wire::Kick{i % 2 == 0 ? d.client() : c.client()});
  ASSERT_TRUE(a.probe.catch_up());
  EXPECT_EQ(kicked(), 0u);
  b.probe.send(wire::Ping{2});
  int notices = 0;
  while (const auto message = b.probe.receive()) {
    if (std::holds_alternative<wire::Pong>(*message)) break;
    notices += std::holds_alternative<wire::Notice>(*message) ? 1 : 0;
  }
  EXPECT_LT(notices, 64);
}

}  // namespace
}  // namespace server
