// The computer stands in for a player who is lost, silent or has left, so that the team's match
// goes on. Sockets are real, time is simulated.
#include <bit>

#include "control_fixture.h"
#include "results/rating.h"
#include "results/store.h"
#include "rod_desk.h"
#include "seats.h"

namespace server {
namespace {

class StandIn : public testing::Test {
 protected:
  static void options(ServerOptions& o) {
    o.limits.seat_kept_us = 30'000'000;
    o.match.rules.idle_seconds = 0.0;
  }
  explicit StandIn(const std::function<void(ServerOptions&)>& change = options) : table(change) {}

  std::optional<wire::Welcome> sit(ProbeClient& client, const std::string& name, std::uint8_t team,
                                   RodSet rods = 0) {
    wire::Hello hello = client.hello(team);
    hello.name = name;
    hello.rods = rods;
    return client.join(hello);
  }
  void begin_match(ProbeClient& pusher, std::uint8_t team = 1) {
    pusher.send(wire::MatchRequest{number(wire::RequestKind::push), team, 0});
    ASSERT_TRUE(table.tick_until(
        [&] { return table->match().view().screen == foosball::Screen::selection; }, 5000));
  }
  void request(ProbeClient& client, const wire::MatchRequest& asked) {
    const std::uint64_t before = table->counters().control.requests;
    client.send(asked);
    ASSERT_TRUE(table.wait_until([&] { return table->counters().control.requests > before; }));
    table.tick(2);
  }
  void claim(ProbeClient& client, const wire::Claim& asked) {
    client.send(asked);
    ASSERT_TRUE(client.catch_up());
    table.tick(3);
  }
  // A player whose hand sends every 100 ms of simulated time.
  struct Hand {
    ProbeClient* client;
    wire::InputDatagram input;
    bool moves = false;
  };
  void plays(ProbeClient& client, const wire::Welcome& seat) {
    Hand hand{&client, {.session = seat.session, .token = seat.token, .sequence = 0}};
    for (wire::InputRod& rod : hand.input.rods) rod = {true, 0.0f, 0.0, 0.0f, 0.0f};
    hands.push_back(hand);
    receive_hands();
  }
  void lets_go(const ProbeClient& client) {
    std::erase_if(hands, [&](const Hand& hand) { return hand.client == &client; });
  }
  void receive_hands() {
    const std::uint64_t received = table->counters().input.accepted;
    for (Hand& hand : hands) {
      ++hand.input.sequence;
      if (hand.moves)
        for (wire::InputRod& rod : hand.input.rods) rod.slide = 0.01f - rod.slide;
      ASSERT_TRUE(hand.client->send_input(hand.input));
    }
    ASSERT_TRUE(table.tick_until(
        [&] { return table->counters().input.accepted == received + hands.size(); }));
  }
  // Ann has team 0, Bob team 1, and both send. Returns her Welcome; none if it failed.
  auto play_both(ProbeClient& ann, ProbeClient& bob) {
    auto seat = sit(ann, "Ann", 0);
    const auto opponent = sit(bob, "Bob", 1);
    if (!seat || !opponent) seat.reset();
    if (seat) {
      plays(ann, *seat);
      plays(bob, *opponent);
    }
    return seat;
  }
  // Simulated time: that of the ticks.
  void pass(std::int64_t us) {
    for (constexpr std::int64_t kEveryUs = 100'000; us > 0; us -= kEveryUs) {
      table.tick(static_cast<int>(std::min(us, kEveryUs) / 1000));
      receive_hands();
    }
  }
  std::uint8_t source(ProbeClient& at, int rod) {
    while (wait_readable(at.udp(), 0)) at.snapshot(0);  // a full buffer would drop newer ones
    table.tick();
    std::optional<wire::Snapshot> newest;
    while (wait_readable(at.udp(), 0)) newest = at.snapshot(0);
    return newest ? newest->rods[rod].source : 255;
  }
  bool logged(const std::string& text) {
    return table.tick_until([&] { return table.log().find(text) != std::string::npos; }, 5000);
  }

  std::vector<Hand> hands;
  const RodSet all0 = rods_of_team(foosball::MatchDesc{}.layout, 0);
  const RodSet all1 = rods_of_team(foosball::MatchDesc{}.layout, 1);
  const RodSet one = RodSet(all0 & -all0), rest = RodSet(all0 & ~one);
  const int goalie = std::countr_zero(one);
  static constexpr auto kClient = number(wire::RodSource::client),
                        kComputer = number(wire::RodSource::computer),
                        kNone = number(wire::RodSource::none);
  Lockstep table;
};

TEST_F(StandIn, PlaysForALostPlayerAfterAGapUntilTheHandIsHeardAgain) {
  ProbeClient ann(table.port()), bob(table.port());
  const auto seat = play_both(ann, bob);
  ASSERT_TRUE(seat);
  begin_match(bob);
  lets_go(ann);
  ann.leave();
  ASSERT_TRUE(table.wait_until([&] { return table->counters().control.lost == 1; }));
  pass(RodDesk::kStandInAfterUs / 2);
  EXPECT_NE(source(bob, goalie), kComputer) << "a short gap is none";
  pass(RodDesk::kStandInAfterUs);
  EXPECT_EQ(source(bob, goalie), kComputer);
  EXPECT_TRUE(logged("the computer plays rods " + to_text(all0) + " for Ann"));
  ProbeClient rival(table.port());
  EXPECT_FALSE(rival.join(0)) << "the seat is kept all the same";
  ProbeClient again(table.port());
  const auto back = again.resume(*seat);
  ASSERT_TRUE(back);
  EXPECT_EQ(back->rods, all0);
  ASSERT_TRUE(table.wait_until([&] { return table->counters().control.resumed == 1; }));
  pass(RodDesk::kStandInAfterUs / 2);
  EXPECT_EQ(source(bob, goalie), kComputer) << "the connection alone moves no rod";
  plays(again, *back);
  EXPECT_EQ(source(bob, goalie), kClient);
  EXPECT_TRUE(logged("the computer replaces nobody any more"));
}

TEST_F(StandIn, PlaysForOneWhoHasNeverSentAnything) {
  ProbeClient ann(table.port()), bob(table.port());
  const auto seat = sit(ann, "Ann", 0), opponent = sit(bob, "Bob", 1);
  ASSERT_TRUE(seat && opponent);
  plays(bob, *opponent);
  begin_match(bob);
  pass(RodDesk::kStandInAfterUs + 100'000);
  EXPECT_EQ(source(bob, goalie), kComputer) << "the way of the datagrams is dead";
  plays(ann, *seat);
  EXPECT_EQ(source(bob, goalie), kClient);
}

TEST_F(StandIn, PlaysForNobodyWhereAllAreSilent) {
  ProbeClient ann(table.port()), bob(table.port()), watcher(table.port());
  ASSERT_TRUE(play_both(ann, bob) && watcher.join());
  begin_match(bob);
  lets_go(ann);
  pass(RodDesk::kStandInAfterUs + 100'000);
  EXPECT_EQ(source(watcher, goalie), kComputer) << "Bob is there to play against";
  lets_go(bob);
  pass(RodDesk::kStandInAfterUs + 100'000);
  EXPECT_EQ(source(watcher, goalie), kClient);
  EXPECT_FALSE(table->match().view().computer[0] || table->match().view().computer[1])
      << "else the rule for idle ones would not end it";
}

TEST_F(StandIn, OffersALeaversRodsToTheTeamMateFirst) {
  ProbeClient ann(table.port()), bob(table.port()), carl(table.port());
  const auto mate = sit(bob, "Bob", 0, rest), opponent = sit(carl, "Carl", 1);
  ASSERT_TRUE(mate && opponent && sit(ann, "Ann", 0, one));
  plays(bob, *mate);
  plays(carl, *opponent);
  begin_match(carl);
  ann.send_goodbye();
  ASSERT_TRUE(table.tick_until([&] { return table->clients() == 2; }));
  EXPECT_TRUE(
      logged("reserved for the team for 10 s, then played by the computer: rods 1 for Ann"));
  EXPECT_EQ(source(carl, goalie), kNone);
  bob.send(wire::Claim{all0});
  ASSERT_TRUE(bob.catch_up());
  table.tick(2);
  EXPECT_TRUE(logged("no rods are offered any more"));
  pass(RodDesk::kOfferUs + 1'000'000);
  EXPECT_NE(source(carl, goalie), kComputer) << "the team mate has them";
}

TEST_F(StandIn, OffersNothingToATeamMateWhoIsNotHeard) {
  ProbeClient ann(table.port()), bob(table.port()), carl(table.port());
  const auto first = sit(ann, "Ann", 0, one), opponent = sit(carl, "Carl", 1);
  ASSERT_TRUE(first && opponent && sit(bob, "Bob", 0, rest));
  plays(ann, *first);
  plays(carl, *opponent);
  begin_match(carl);
  pass(RodDesk::kStandInAfterUs + 100'000);
  EXPECT_EQ(source(carl, std::countr_zero(rest)), kComputer) << "for Bob";
  lets_go(ann);
  ann.send_goodbye();
  ASSERT_TRUE(table.tick_until([&] { return table->clients() == 2; }));
  table.tick(3);
  EXPECT_EQ(source(carl, goalie), kComputer) << "at once: Bob takes nothing";
}

TEST_F(StandIn, PlaysForALeaverWhoseTeamMateDoesNotTakeTheRodsUntilSomebodyDoes) {
  ProbeClient ann(table.port()), bob(table.port()), carl(table.port());
  const auto mate = sit(bob, "Bob", 0, rest), opponent = sit(carl, "Carl", 1);
  ASSERT_TRUE(mate && opponent && sit(ann, "Ann", 0, one));
  plays(bob, *mate);
  plays(carl, *opponent);
  begin_match(carl);
  ann.send_goodbye();
  ASSERT_TRUE(table.tick_until([&] { return table->clients() == 2; }));
  pass(RodDesk::kOfferUs + 1'000'000);
  EXPECT_EQ(source(carl, goalie), kComputer);
  EXPECT_NE(source(carl, std::countr_zero(rest)), kComputer) << "Bob plays his own";
  EXPECT_FALSE(table->match().view().computer[0]) << "a team with a person is a person's";
  ProbeClient dora(table.port());
  const auto joined = sit(dora, "Dora", 0);
  ASSERT_TRUE(joined);
  EXPECT_EQ(joined->rods, one);
  ASSERT_TRUE(table.tick_until([&] { return table->clients() == 3; }));
  EXPECT_NE(source(carl, goalie), kComputer);
}

TEST_F(StandIn, PlaysAtOnceForTheLastOfATeam) {
  ProbeClient ann(table.port()), bob(table.port());
  const auto opponent = sit(bob, "Bob", 1);
  ASSERT_TRUE(opponent && sit(ann, "Ann", 0));
  plays(bob, *opponent);
  begin_match(bob);
  ann.send_goodbye();
  ASSERT_TRUE(table.tick_until([&] { return table->clients() == 1; }));
  table.tick(3);
  EXPECT_EQ(source(bob, goalie), kComputer);
  EXPECT_TRUE(table.tick_until([&] { return table->match().view().computer[0]; }));
}

// The match goes on for the other player, whether this one watches or changes teams.
TEST_F(StandIn, PlaysForOneWhoGivesTheRodsUpUntilTheyAreTakenAgain) {
  ProbeClient ann(table.port()), bob(table.port());
  const auto opponent = sit(bob, "Bob", 1);
  ASSERT_TRUE(opponent && sit(ann, "Ann", 0));
  plays(bob, *opponent);
  begin_match(bob);
  claim(ann, {0, wire::kWatchOnly});
  EXPECT_EQ(source(bob, goalie), kComputer);
  EXPECT_TRUE(logged("for Ann"));
  claim(ann, {one, 0});
  EXPECT_NE(source(bob, goalie), kComputer) << "she has it again";
  EXPECT_EQ(source(bob, std::countr_zero(rest)), kComputer);
}

TEST_F(StandIn, PlaysForOneWhoChangesSides) {
  ProbeClient ann(table.port()), bob(table.port());
  const auto opponent = sit(bob, "Bob", 1, RodSet(all1 & (all1 - 1)));
  ASSERT_TRUE(opponent && sit(ann, "Ann", 0));
  plays(bob, *opponent);
  begin_match(bob);
  claim(ann, {RodSet(all1 & -all1), 1});
  EXPECT_EQ(source(bob, goalie), kComputer);
}

TEST_F(StandIn, OffersTheRodsThatAreGivenUpToTheTeamMateFirst) {
  ProbeClient ann(table.port()), bob(table.port()), carl(table.port());
  const auto mate = sit(bob, "Bob", 0, rest), opponent = sit(carl, "Carl", 1);
  ASSERT_TRUE(mate && opponent && sit(ann, "Ann", 0, one));
  plays(bob, *mate);
  plays(carl, *opponent);
  begin_match(carl);
  ann.send(wire::Claim{0, wire::kWatchOnly});
  EXPECT_TRUE(
      logged("reserved for the team for 10 s, then played by the computer: rods 1 for Ann"));
  EXPECT_EQ(source(carl, goalie), kNone);
  pass(RodDesk::kOfferUs + 1'000'000);
  EXPECT_EQ(source(carl, goalie), kComputer);
}

// Giving up some rods of the team is a choice, not leaving.
TEST_F(StandIn, LeavesRodsAloneThatOneDoesNotWantWhoPlaysOn) {
  ProbeClient ann(table.port()), bob(table.port());
  ASSERT_TRUE(play_both(ann, bob));
  begin_match(bob);
  claim(ann, {rest, 0});
  pass(RodDesk::kOfferUs + 1'000'000);
  EXPECT_EQ(source(bob, goalie), kNone);
}

TEST_F(StandIn, KeepsNoMatchGoingThatAllHaveLeft) {
  ProbeClient ann(table.port()), watcher(table.port());
  ASSERT_TRUE(sit(ann, "Ann", 0) && watcher.join());
  begin_match(ann, 0);
  ann.send_goodbye();
  ASSERT_TRUE(table.wait_until([&] { return table->counters().control.left == 1; }));
  pass(RodDesk::kOfferUs);
  EXPECT_EQ(source(watcher, goalie), kNone);
}

TEST_F(StandIn, PlaysForAClientThatFellSilentThoughItsConnectionStands) {
  ProbeClient ann(table.port()), bob(table.port());
  ASSERT_TRUE(play_both(ann, bob));
  begin_match(bob);
  EXPECT_EQ(source(bob, goalie), kClient);
  const Hand hand = hands.front();
  lets_go(ann);
  pass(RodDesk::kStandInAfterUs + 10'000);
  EXPECT_EQ(source(bob, goalie), kComputer);
  hands.push_back(hand);
  receive_hands();
  EXPECT_EQ(source(bob, goalie), kClient) << "heard again, it has its rods in that tick";
}

TEST_F(StandIn, PlaysForOneWhoIsThereAndMovesNothingInPlay) {
  ProbeClient ann(table.port()), bob(table.port());
  ASSERT_TRUE(play_both(ann, bob));
  hands[1].moves = true;
  begin_match(bob);
  for (ProbeClient* client : {&ann, &bob}) {
    const auto team = static_cast<std::uint8_t>(client == &ann ? 0 : 1);
    client->send(wire::MatchRequest{number(wire::RequestKind::push), team, 0});
  }
  ASSERT_TRUE(
      table.tick_until([&] { return table->match().view().screen == foosball::Screen::play; }));
  for (int i = 0; i < 600 && source(bob, goalie) != kComputer; ++i) pass(100'000);
  EXPECT_EQ(source(bob, goalie), kComputer);
  EXPECT_TRUE(logged("the computer plays rods " + to_text(all0) + " for Ann"));
  hands[0].moves = true;
  pass(200'000);
  EXPECT_EQ(source(bob, goalie), kClient) << "at the first movement";
}

class Alone : public StandIn {
 protected:
  static void against_the_computer(ServerOptions& o) {
    options(o);
    o.computer = {false, true};
    o.match.rules.idle_seconds = 12.0;
  }
  Alone() : StandIn(against_the_computer) {}
};

TEST_F(Alone, AGapInTheOnlyPlayersLineCostsNoGoals) {
  ProbeClient ann(table.port());
  const auto seat = sit(ann, "Ann", 0);
  ASSERT_TRUE(seat);
  plays(ann, *seat);
  begin_match(ann, 0);
  ann.send(wire::MatchRequest{number(wire::RequestKind::push), 0, 0});
  ASSERT_TRUE(
      table.tick_until([&] { return table->match().view().screen == foosball::Screen::play; }));
  receive_hands();
  const Hand hand = hands.front();
  lets_go(ann);
  pass(RodDesk::kStandInAfterUs / 2);
  EXPECT_FALSE(table->match().view().paused);
  pass(RodDesk::kStandInAfterUs / 2 + 10'000);
  EXPECT_TRUE(table->match().view().paused);
  EXPECT_TRUE(logged("the match waits"));
  hands.push_back(hand);
  pass(10'000);
  EXPECT_FALSE(table->match().view().paused);
  EXPECT_TRUE(logged("the match continues"));
  lets_go(ann);
  pass(RodDesk::kStandInAfterUs + 10'000);
  EXPECT_TRUE(table->match().view().paused);
  pass(12'000'000);
  EXPECT_EQ(table->match().view().screen, foosball::Screen::logo) << "it waits for nobody for long";
}

TEST_F(Alone, APausePlayersAskedForOutlastsTheirSilence) {
  ProbeClient ann(table.port());
  const auto seat = sit(ann, "Ann", 0);
  ASSERT_TRUE(seat);
  plays(ann, *seat);
  begin_match(ann, 0);
  ann.send(wire::MatchRequest{number(wire::RequestKind::push), 0, 0});
  ASSERT_TRUE(
      table.tick_until([&] { return table->match().view().screen == foosball::Screen::play; }));
  receive_hands();
  // A reconnection before the silence, and during it.
  for (const bool silent_first : {false, true}) {
    const Hand hand = hands.front();
    const auto fall_silent = [&] {
      lets_go(ann);
      pass(RodDesk::kStandInAfterUs + 100'000);
    };
    if (silent_first) fall_silent();
    EXPECT_EQ(table->match().view().paused, silent_first);
    request(ann, {number(wire::RequestKind::pause), 0, 1});
    if (!silent_first) fall_silent();
    hands.push_back(hand);
    pass(100'000);
    EXPECT_TRUE(table->match().view().paused) << silent_first;
    request(ann, {number(wire::RequestKind::pause), 0, 0});
    pass(100'000);
    EXPECT_FALSE(table->match().view().paused) << silent_first;
  }
}

TEST_F(Alone, NobodyIsHeardSoNobodyGoesOn) {
  ProbeClient ann(table.port());
  const auto seat = sit(ann, "Ann", 0);
  ASSERT_TRUE(seat);
  plays(ann, *seat);
  begin_match(ann, 0);
  request(ann, {number(wire::RequestKind::push), 0, 0});
  ASSERT_TRUE(
      table.tick_until([&] { return table->match().view().screen == foosball::Screen::play; }));
  receive_hands();
  lets_go(ann);
  pass(RodDesk::kStandInAfterUs + 100'000);
  request(ann, {number(wire::RequestKind::pause), 0, 0});
  pass(100'000);
  EXPECT_TRUE(table->match().view().paused) << "the datagrams do not arrive";
}

class StandInResults : public StandIn {
 protected:
  static std::string path() { return temp_path("results.sqlite"); }
  static void rated(ServerOptions& o) {
    options(o);
    o.match.rules.match_seconds = 8.0;
    o.match.rules.golden_goal = false;
    o.results = path();
    o.date = [] { return std::string("2026-11-22T20:00:00Z"); };
  }
  explicit StandInResults(const std::function<void(ServerOptions&)>& change = rated)
      : StandIn((std::filesystem::remove(path()), change)) {}

  // Three people, one second into their match.
  void begin_three() {
    const auto first = sit(ann, "Ann", 0, one), mate = sit(bob, "Bob", 0, rest),
               opponent = sit(carl, "Carl", 1);
    ASSERT_TRUE(first && mate && opponent);
    plays(ann, *first);
    plays(bob, *mate);
    plays(carl, *opponent);
    begin_match(carl);
    for (ProbeClient* one_of : {&bob, &carl}) {
      const auto team = static_cast<std::uint8_t>(one_of == &bob ? 0 : 1);
      one_of->send(wire::MatchRequest{number(wire::RequestKind::push), team, 0});
    }
    ASSERT_TRUE(
        table.tick_until([&] { return table->match().view().screen == foosball::Screen::play; }));
    pass(1'000'000);
    ann_id = first->client;
  }
  bool end() {
    const auto over = [&] { return table->match().view().screen == foosball::Screen::end; };
    for (int i = 0; i < 300 && !over(); ++i) pass(100'000);
    return over();
  }
  std::optional<results::MatchResult> result() {
    table->finish(wire::Sentence::untranslated("done"));
    const auto store = results::Store::open(path(), results::Access::read_only);
    const auto matches = store ? store->matches({}).value() : std::vector<results::MatchResult>{};
    return matches.size() == 1 ? std::optional(matches[0]) : std::nullopt;
  }
  static const results::Player* find(const results::MatchResult& match, const std::string& name) {
    for (const results::Team& team : match.teams)
      for (const results::Player& player : team.players)
        if (player.name == name) return &player;
    return nullptr;
  }
  ProbeClient ann{table.port()}, bob{table.port()}, carl{table.port()};
  std::uint32_t ann_id = 0;
};

TEST_F(StandInResults, AreADefeatForWhoLeavesTheMatch) {
  begin_three();
  lets_go(ann);
  ann.send_goodbye();
  ASSERT_TRUE(end());
  EXPECT_TRUE(logged("players who leave a match lose it: Ann ("));
  const auto match = result();
  ASSERT_TRUE(match && find(*match, "Ann"));
  EXPECT_TRUE(find(*match, "Ann")->left);
  EXPECT_FALSE(find(*match, "Bob")->left || find(*match, "Carl")->left);
  const auto all = results::standings(std::vector{*match});
  const auto standing = std::ranges::find(all, "Ann", &results::Standing::name);
  EXPECT_LT(standing->rating, results::kFirstRating);
}

class StandInResultsOfGuests : public StandInResults {
 protected:
  static void guests(ServerOptions& o) {
    rated(o);
    o.access.trust_this_machine = false;
    o.access.password = "open sesame";
    o.access.host_password = "mine";
  }
  StandInResultsOfGuests() : StandInResults(guests) {}
};

TEST_F(StandInResultsOfGuests, AreNoDefeatForWhoIsPutOut) {
  ASSERT_TRUE(ann.prove("open sesame") && bob.prove("open sesame"));
  ASSERT_TRUE(carl.prove("mine", wire::Role::host));
  begin_three();
  carl.send(wire::Kick{ann_id});
  ASSERT_TRUE(table.tick_until([&] { return table->clients() == 2; }));
  lets_go(ann);
  ASSERT_TRUE(end());
  const auto match = result();
  ASSERT_TRUE(match && find(*match, "Ann"));
  EXPECT_FALSE(find(*match, "Ann")->left);
  EXPECT_FALSE(results::counts_for(*find(*match, "Ann")));
}

TEST_F(StandInResults, CountForNobodyForWhomTheComputerPlayedMuchOfTheMatch) {
  begin_three();
  lets_go(ann);
  ASSERT_TRUE(end());
  EXPECT_TRUE(
      logged("the match does not count for the rating of players who played too little of it: "
             "Ann ("));
  const auto match = result();
  ASSERT_TRUE(match);
  const auto& team = match->teams[0].players;
  ASSERT_EQ(team.size(), 3u);
  EXPECT_EQ(team[0], (results::Player{"Bob", "person", 1.0})) << "not of the first seat alone";
  for (const results::Player& player : {team[1], team[2]}) {
    EXPECT_TRUE(player.name == "Ann" || player.name == "computer 2") << player.name;
    EXPECT_FALSE(results::counts_for(player));
  }
  EXPECT_NEAR(team[1].share + team[2].share, 1.0, 1e-9);
  EXPECT_EQ(match->teams[1].players, (std::vector{results::Player{"Carl", "person", 1.0}}));
}

TEST_F(StandIn, IsNoneBeforeAMatch) {
  ProbeClient ann(table.port()), bob(table.port());
  ASSERT_TRUE(sit(ann, "Ann", 0) && sit(bob, "Bob", 1));
  ann.leave();
  ASSERT_TRUE(table.wait_until([&] { return table->counters().control.lost == 1; }));
  pass(RodDesk::kStandInAfterUs + 100'000);
  EXPECT_NE(source(bob, goalie), kComputer);
}

}  // namespace
}  // namespace server
