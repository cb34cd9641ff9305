// The game, chosen by clients while the server runs.
#include <algorithm>
#include <atomic>

#include "control_fixture.h"
#include "server/game_choice.h"
#include "server/playback.h"
#include "wire/enums.h"

namespace server {
namespace {

wire::Game of(wire::Mode mode) {
  wire::Game game;
  game.mode = number(mode);
  return game;
}

bool receives_game(Lockstep& table, ProbeClient& client,
                   const std::function<bool(const wire::Game&)>& wanted) {
  return table.tick_until(
      [&] { return client.catch_up() && client.game() && wanted(*client.game()); });
}

class GameTest : public testing::Test {
 protected:
  GameTest()
      : table([](ServerOptions& o) {
          o.computer = {false, true};
          o.date = [] { return std::string("2026-11-22T12:00:00Z"); };
          o.record = temp_path("journal");
          o.overwrite = true;
        }) {}
  const foosball::MatchView& view() { return table->match().view(); }
  bool reported(ProbeClient& client, const std::function<bool(const wire::Game&)>& wanted) {
    return receives_game(table, client, wanted);
  }
  void request(ProbeClient& client, wire::RequestKind kind) {
    const auto before = table->counters().control.requests;
    client.send(wire::MatchRequest{number(kind), 0, 0});
    ASSERT_TRUE(table.wait_until([&] { return table->counters().control.requests > before; }));
    table.tick(10);
  }
  Lockstep table;
};

TEST_F(GameTest, AClientReachesTrainingAndLadderAndAllAreTold) {
  ProbeClient host(table.port()), other(table.port());
  ASSERT_TRUE(host.join(0));
  ASSERT_TRUE(other.join());
  ASSERT_TRUE(reported(other, [](const auto& g) { return g.mode == 0 && g.goals == 5; }));
  wire::Game training = of(wire::Mode::training);
  training.level = 4;
  training.style = 2;
  host.send(training);
  ASSERT_TRUE(reported(other, [&](const auto& g) { return g == training; }));
  EXPECT_EQ(view().mode, foosball::Mode::training);
  wire::Game ladder = of(wire::Mode::ladder);
  ladder.goals = 3;
  ladder.sets = 1;
  host.send(ladder);
  ASSERT_TRUE(reported(other, [&](const auto& g) { return g == ladder; }));
  EXPECT_EQ(view().mode, foosball::Mode::ladder);
  EXPECT_EQ(view().rules.goals_to_win, 3);
  ProbeClient late(table.port());
  ASSERT_TRUE(late.join());
  ASSERT_TRUE(late.catch_up());
  EXPECT_EQ(late.game(), ladder);
}

TEST_F(GameTest, InPlayItWaitsForARestartAndSaysSo) {
  ProbeClient host(table.port());
  ASSERT_TRUE(host.join(0));
  request(host, wire::RequestKind::push);
  request(host, wire::RequestKind::push);
  ASSERT_TRUE(table.tick_until([&] { return view().screen == foosball::Screen::play; }));
  wire::Game game = of(wire::Mode::match);
  game.goals = 2;
  game.level = 5;
  host.send(game);
  ASSERT_TRUE(
      reported(host, [](const auto& g) { return g.goals == 2 && g.level == 5 && g.waits; }));
  EXPECT_EQ(view().rules.goals_to_win, 5);
  request(host, wire::RequestKind::restart);
  ASSERT_TRUE(reported(host, [](const auto& g) { return g.goals == 2 && !g.waits; }));
  EXPECT_EQ(view().rules.goals_to_win, 2);
}

TEST_F(GameTest, OutOfRangeAndContradictingValuesAreRefusedWithASentence) {
  ProbeClient host(table.port());
  ASSERT_TRUE(host.join(0));
  ASSERT_TRUE(reported(host, [](const auto&) { return true; }));
  const wire::Game before = *host.game();
  wire::Game bad = of(wire::Mode::match);
  bad.goals = 100;
  host.send(bad);
  EXPECT_EQ(notice_of(host), wire::make_sentence<wire::SentenceId::no_such_game>().text());
  bad = of(wire::Mode::ladder);
  bad.level = 3;
  host.send(bad);
  EXPECT_EQ(notice_of(host), wire::make_sentence<wire::SentenceId::ladder_has_its_levels>().text());
  bad = of(wire::Mode::challenge);
  bad.goals = 3;
  host.send(bad);
  EXPECT_EQ(notice_of(host), wire::make_sentence<wire::SentenceId::challenge_is_set>().text());
  table.tick(20);
  ASSERT_TRUE(host.catch_up());
  EXPECT_EQ(host.game(), before);
  host.send(of(wire::Mode::training));
  EXPECT_EQ(host.receive_a<wire::Notice>().value_or(wire::Notice{}).level,
            wire::Notice::Level::cleared)
      << "what is taken leaves no refusal standing";
}

TEST_F(GameTest, TheChallengeIsTodaysAndKeepsTheDefaultTuning) {
  ProbeClient host(table.port());
  ASSERT_TRUE(host.join(0));
  host.send(wire::MatchRequest{number(wire::RequestKind::tune), 0, 0, 9.0});
  ASSERT_TRUE(table.tick_until(
      [&] { return host.catch_up() && host.tuning() && host.tuning()->values[0] == 9.0; }));
  host.send(of(wire::Mode::challenge));
  EXPECT_EQ(notice_of(host), wire::make_sentence<wire::SentenceId::challenge_tuning>().text());
  const double usual = foosball::Tuning{}.gravity;
  host.send(wire::MatchRequest{number(wire::RequestKind::tune), 0, 0, usual});
  ASSERT_TRUE(
      table.tick_until([&] { return host.catch_up() && host.tuning()->values[0] == usual; }));
  host.send(of(wire::Mode::challenge));
  const auto drawn = foosball::challenge_opponent(20261122);
  ASSERT_TRUE(reported(host, [&](const auto& g) { return g.date == 20261122; }));
  EXPECT_EQ(host.game()->level, drawn.level);
  EXPECT_EQ(view().challenge, 20261122u);
  host.send(wire::MatchRequest{number(wire::RequestKind::tune), 0, 0, 9.0});
  EXPECT_TRUE(table.tick_until([&] {
    return notice_of(host) ==
           wire::make_sentence<wire::SentenceId::challenge_keeps_tuning>().text();
  }));
  table.tick(20);
  EXPECT_EQ(view().tuning.gravity, usual);
}

TEST_F(GameTest, AChangeOfSidesIsForACabinet) {
  ProbeClient host(table.port());
  ASSERT_TRUE(host.join(0));
  wire::Game game = of(wire::Mode::match);
  game.sets = 3;
  game.change_sides = true;
  host.send(game);
  EXPECT_EQ(notice_of(host), wire::make_sentence<wire::SentenceId::sides_at_a_cabinet>().text());
}

// A server that runs past midnight.
class Midnight : public testing::Test {
 protected:
  std::atomic<int> day{22};
  Lockstep table{[this](ServerOptions& o) {
    o.computer = {false, true};
    o.match = foosball::challenge_of(20261122);
    o.match.rules.attract_seconds = o.match.rules.idle_seconds = 0.0;
    o.challenge_date = pinned;
    o.date = [this] { return "2026-11-" + std::to_string(day) + "T12:00:00Z"; };
  }};
  static inline std::uint32_t pinned = 0;
};

TEST_F(Midnight, BringsTheNextDaysChallengeToTheMatchesThatBeginAfterIt) {
  ProbeClient player(table.port());
  ASSERT_TRUE(player.join(0));
  player.send(wire::MatchRequest{number(wire::RequestKind::push), 0, 0});
  const auto& view = table->match().view();
  ASSERT_TRUE(table.tick_until([&] { return view.screen == foosball::Screen::play; }));
  day = 23;
  ASSERT_TRUE(table.tick_until(
      [&] { return player.catch_up() && player.game() && player.game()->date == 20261123; }));
  EXPECT_TRUE(player.game()->waits);
  EXPECT_EQ(view.challenge, 20261122u) << "the match in hand stays that of its day";
  player.send(wire::MatchRequest{number(wire::RequestKind::restart), 0, 0});
  ASSERT_TRUE(table.tick_until([&] { return view.screen == foosball::Screen::logo; }));
  ASSERT_TRUE(table.tick_until([&] { return player.catch_up() && !player.game()->waits; }));
  EXPECT_EQ(view.challenge, 20261123u);
  const auto opponent = foosball::challenge_opponent(20261123);
  EXPECT_EQ(player.game()->level, opponent.level);
}

class GivenDay : public Midnight {
 protected:
  static void SetUpTestSuite() { pinned = 20261122; }
  static void TearDownTestSuite() { pinned = 0; }
};

TEST_F(GivenDay, StaysAndIsWhatAHostChooses) {
  day = 23;
  ProbeClient host(table.port());
  ASSERT_TRUE(host.join(0));
  host.send(of(wire::Mode::match));
  ASSERT_TRUE(receives_game(table, host,
                            [](const auto& g) { return g.mode == number(wire::Mode::match); }));
  host.send(of(wire::Mode::challenge));
  ASSERT_TRUE(receives_game(table, host,
                            [](const auto& g) { return g.mode == number(wire::Mode::challenge); }));
  EXPECT_EQ(host.game()->date, 20261122u);
}

// Equal inputs in every attempt: the computer then plays equally, although other things happened in
// between.
TEST(Challenge, TheComputerBeginsEveryTryOfADayInTheSameState) {
  Lockstep table([](ServerOptions& o) {
    o.computer = {false, true};
    o.match = foosball::challenge_of(20261122);
    o.match.rules.attract_seconds = o.match.rules.idle_seconds = 0.0;
  });
  ProbeClient player(table.port());
  const auto welcome = player.join(0);
  ASSERT_TRUE(welcome);
  wire::InputDatagram hand;
  hand.session = welcome->session;
  hand.token = welcome->token;
  for (auto& rod : hand.rods) rod = {true, 0.0f, 0.0, 0.0f, 0.0f};
  const auto hold_still = [&] {  // present, so that the match does not wait
    ++hand.sequence;
    player.send_input(hand);
  };
  const auto ask = [&](wire::RequestKind kind) {
    player.send(wire::MatchRequest{number(kind), 0, 0});
    const auto wanted =
        kind == wire::RequestKind::push ? foosball::Screen::play : foosball::Screen::logo;
    ASSERT_TRUE(table.tick_until([&] { return table->match().view().screen == wanted; }));
  };
  std::vector<std::vector<double>> tries;
  for (int i = 0; i < 3; ++i) {
    hold_still();
    ask(wire::RequestKind::push);
    std::vector<double> moved;
    // Until its hand answers the serve, half a second after the start.
    for (int tick = 0; tick < 900; ++tick) {
      if (tick % 300 == 0) hold_still();
      table.tick();
      ASSERT_FALSE(table->match().view().paused);
      const auto& rods = table->match().view().rods;
      for (int rod = 0; rod < foosball::kRods; ++rod)
        if (foosball::table_spec(foosball::Layout::tournament).rods[rod].team == 1)
          moved.push_back(rods[rod].slide);
    }
    tries.push_back(std::move(moved));
    ask(wire::RequestKind::restart);
    table.tick(777 + 111 * i);
  }
  for (int i : {1, 2}) {
    const auto differs = std::ranges::mismatch(tries[0], tries[i]).in1;
    EXPECT_EQ(differs, tries[0].end()) << "after tick " << (differs - tries[0].begin()) / 4;
  }
}

TEST(GameFromAfar, AWatcherAndAPlayerAreRefusedAndAHostIsNot) {
  Lockstep table([](ServerOptions& o) {
    o.access.password = "correct horse";
    o.access.host_password = "battery staple";
    o.access.trust_this_machine = false;
    o.computer = {false, true};
  });
  ProbeClient watcher(table.port()), player(table.port()), host(table.port());
  ASSERT_TRUE(watcher.prove("correct horse", wire::Role::watcher));
  ASSERT_TRUE(watcher.join());
  ASSERT_TRUE(player.prove("correct horse"));
  ASSERT_TRUE(player.join(0));
  for (ProbeClient* client : {&watcher, &player}) {
    client->send(of(wire::Mode::training));
    EXPECT_EQ(notice_of(*client),
              wire::make_sentence<wire::SentenceId::only_host_chooses>().text());
  }
  table.tick(20);
  EXPECT_EQ(table->match().view().mode, foosball::Mode::match);
  ASSERT_TRUE(host.prove("battery staple", wire::Role::host));
  ASSERT_TRUE(host.join());
  host.send(of(wire::Mode::training));
  EXPECT_TRUE(
      table.tick_until([&] { return table->match().view().mode == foosball::Mode::training; }));
}

TEST_F(GameTest, ARecordingOfChangedGamesReplaysToTheBit) {
  const std::string path = temp_path("journal");
  {
    ProbeClient host(table.port());
    ASSERT_TRUE(host.join(0));
    wire::Game game = of(wire::Mode::match);
    game.goals = 1;
    game.match_ms = 60'000;
    host.send(game);
    ASSERT_TRUE(reported(host, [](const auto& g) { return g.goals == 1; }));
    request(host, wire::RequestKind::push);
    request(host, wire::RequestKind::push);
    ASSERT_TRUE(table.tick_until([&] { return view().screen == foosball::Screen::play; }));
    table.tick(1200);
    host.send(of(wire::Mode::challenge));
    ASSERT_TRUE(reported(host, [](const auto& g) { return g.waits; }));
    request(host, wire::RequestKind::restart);
    request(host, wire::RequestKind::push);
    ASSERT_EQ(view().mode, foosball::Mode::challenge);
    table.tick(1500);
  }
  table->finish(wire::make_sentence<wire::SentenceId::server_ends>());
  auto playback = Playback::open(path);
  ASSERT_TRUE(playback) << playback.error();
  Lockstep replay([&](ServerOptions& o) { o.replay = std::move(*playback); });
  ProbeClient watcher(replay.port());
  ASSERT_TRUE(watcher.join());
  while (!replay->replay_over()) replay.tick();
  EXPECT_EQ(replay->replay()->verdict(), Playback::Verdict::same)
      << replay->replay()->verdict_sentence();
  EXPECT_EQ(replay->match().state_hash(), table->match().state_hash());
  ASSERT_TRUE(watcher.catch_up());
  EXPECT_EQ(watcher.game()->date, 20261122u);
  watcher.send(of(wire::Mode::training));
  EXPECT_EQ(notice_of(watcher), wire::make_sentence<wire::SentenceId::recording_plays>().text());
}

}  // namespace
}  // namespace server
