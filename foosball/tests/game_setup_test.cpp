// Changing the game while a match runs: the meaning of a setup, when it takes effect, and that such
// a match is saved and replayed bit for bit.
#include "foosball/game_setup.h"

#include <set>

#include "foosball/computer_player.h"
#include "match_fixture.h"

namespace foosball {
namespace {

// --- meaning of a setup --------------------------------------------------------------------------

TEST(GameSetup, ADateIsADayOfTheCalendar) {
  for (const std::uint32_t day : {20261122u, 20240229u, 20000229u, 20261231u, 10000101u})
    EXPECT_TRUE(is_date(day)) << day;
  for (const std::uint32_t none : {20260231u, 20260229u, 19000229u, 20260431u, 20261301u, 20260010u,
                                   20260100u, 20260132u, 0u, 9991231u, 4000000000u})
    EXPECT_FALSE(is_date(none)) << none;
}

TEST(GameSetup, RulesAreThoseOfTheSetWithWhatIsChosenOfThem) {
  EXPECT_EQ(rules_of({}), arcade_rules());
  EXPECT_EQ(rules_of({.rules = RuleSet::itsf}), itsf_rules());
  EXPECT_EQ(rules_of({.mode = Mode::challenge, .date = 20261122}), challenge_rules());
  const Rules seven = rules_of({.goals = 7, .sets = 3, .change_sides = true});
  EXPECT_EQ(seven.goals_to_win, 7);
  EXPECT_EQ(seven.max_goals, 10);
  EXPECT_EQ(seven.sets_to_win, 2);
  EXPECT_TRUE(seven.change_sides);
  const Rules timed = rules_of({.match_ms = 90'000});
  EXPECT_EQ(timed.match_seconds, 90.0);
  EXPECT_EQ(timed.goals_to_win, 99) << "time ends it, not goals";
  Rules slow;
  slow.end_seconds = 9.0;
  EXPECT_EQ(rules_of({.goals = 1}, slow).end_seconds, 9.0) << "screens are not chosen";
}

TEST(GameSetup, IsReadBackFromItsRules) {
  for (const Mode mode : {Mode::match, Mode::ladder}) {
    for (const int goals : {0, 1, 5, 99}) {
      for (const std::uint32_t ms : {0u, 6'000u, 90'500u, kMaxMatchMs}) {
        const GameSetup setup{mode, RuleSet::itsf, goals, 17, ms, true, 0};
        const Rules rules = rules_of(setup);
        EXPECT_EQ(rules_of(setup_of(mode, rules)), rules) << goals << " " << ms;
      }
    }
  }
  const GameSetup day{.mode = Mode::challenge, .date = 20261122};
  EXPECT_EQ(setup_of(Mode::challenge, rules_of(day), 20261122), day);
}

TEST(GameSetup, WhatContradictsItsModeOrIsOutOfRangeIsNotPlayable) {
  EXPECT_TRUE(playable(GameSetup{}));
  EXPECT_TRUE(playable(GameSetup{.goals = 99, .sets = 17, .match_ms = kMaxMatchMs}));
  EXPECT_TRUE(playable(GameSetup{.mode = Mode::training, .rules = RuleSet::itsf}));
  EXPECT_TRUE(playable(GameSetup{.mode = Mode::challenge, .date = 20261122}));
  for (const GameSetup& bad :
       {GameSetup{.goals = 100}, GameSetup{.goals = -1}, GameSetup{.sets = 2},
        GameSetup{.sets = 19}, GameSetup{.sets = -1}, GameSetup{.match_ms = kMaxMatchMs + 1},
        GameSetup{.mode = static_cast<Mode>(4)}, GameSetup{.rules = static_cast<RuleSet>(2)},
        GameSetup{.date = 20261122}, GameSetup{.mode = Mode::challenge},
        GameSetup{.mode = Mode::challenge, .date = 20260231},
        GameSetup{.mode = Mode::challenge, .goals = 3, .date = 20261122},
        GameSetup{.mode = Mode::challenge, .rules = RuleSet::itsf, .date = 20261122},
        GameSetup{.mode = Mode::training, .match_ms = 60'000},
        GameSetup{.mode = Mode::training, .change_sides = true}}) {
    EXPECT_FALSE(playable(bad));
    if (in_range(bad)) {
      Match match = *Match::create({.layout = Layout::tournament});
      const std::vector<Command> commands{{.kind = Command::Kind::set_up, .setup = bad}};
      match.step({{}, commands});
      EXPECT_EQ(match.view().setup, setup_of(Mode::match, arcade_rules()));
    }
  }
}

TEST(Challenge, ItsOpponentIsDrawnFromItsDateAlone) {
  std::set<std::string> opponents;
  for (std::uint32_t day = 20261101; day <= 20261130; ++day) {
    const PlayerSpec spec = challenge_opponent(day);
    EXPECT_EQ(spec, challenge_opponent(day));
    EXPECT_GE(spec.level, 1);
    EXPECT_LE(spec.level, kLevels);
    opponents.insert(to_text(spec));
  }
  EXPECT_GE(opponents.size(), 10u) << "days differ, of 20 that there are";
}

// --- when it takes effect ------------------------------------------------------------------------

class SetupTest : public MatchTest {
 protected:
  SetupTest() : MatchTest(Layout::tournament, Rules{}) {}
  void set_up(const GameSetup& setup) {
    commands.push_back({.kind = Command::Kind::set_up, .setup = setup});
    step();
  }
};

TEST_F(SetupTest, AtTheLogoAndTheSelectionItIsPlayedAtOnce) {
  set_up({.goals = 1});
  EXPECT_EQ(view().rules.goals_to_win, 1);
  EXPECT_FALSE(view().setup_waits);
  command(Command::Kind::push, 0);
  set_up({.rules = RuleSet::itsf, .goals = 2});
  EXPECT_EQ(view().screen, Screen::selection) << "nobody chooses a character again for it";
  EXPECT_EQ(view().rules.goals_to_win, 2);
  EXPECT_EQ(view().rule_set, RuleSet::itsf);
  set_up({.mode = Mode::training});
  EXPECT_EQ(view().screen, Screen::logo) << "another mode begins at the beginning";
  EXPECT_EQ(view().mode, Mode::training);
}

TEST_F(SetupTest, InPlayItWaitsForTheNextLogo) {
  start_by_commands();
  set_up({.mode = Mode::ladder, .goals = 3});
  EXPECT_EQ(view().mode, Mode::match);
  EXPECT_EQ(view().rules, arcade_rules()) << "the players' rules do not change in their hands";
  EXPECT_TRUE(view().setup_waits);
  EXPECT_EQ(view().setup.mode, Mode::ladder);
  run(1.0);
  EXPECT_EQ(view().screen, Screen::play);
  command(Command::Kind::restart);
  EXPECT_EQ(view().mode, Mode::ladder);
  EXPECT_EQ(view().rules.goals_to_win, 3);
  EXPECT_FALSE(view().setup_waits);
}

TEST_F(SetupTest, TheLastChoiceBeforeTheNextMatchCounts) {
  start_by_commands();
  const GameSetup before = view().setup;
  set_up({.goals = 3});
  EXPECT_TRUE(view().setup_waits);
  set_up(before);
  EXPECT_FALSE(view().setup_waits);
}

TEST_F(SetupTest, EndsTheMatchThatComputersShow) {
  run(31.0);
  ASSERT_TRUE(view().attract);
  set_up({.goals = 1});
  EXPECT_FALSE(view().attract);
  EXPECT_EQ(view().screen, Screen::logo);
  EXPECT_EQ(view().rules.goals_to_win, 1);
}

TEST_F(SetupTest, EveryModeIsReachedFromEveryOther) {
  const std::array<GameSetup, kModes> all{
      GameSetup{.mode = Mode::match}, GameSetup{.mode = Mode::training},
      GameSetup{.mode = Mode::challenge, .date = 20261122}, GameSetup{.mode = Mode::ladder}};
  for (const GameSetup& from : all) {
    for (const GameSetup& to : all) {
      set_up(from);
      set_up(to);
      ASSERT_EQ(view().mode, to.mode);
      command(Command::Kind::push, 0);
      if (view().screen == Screen::selection) command(Command::Kind::push, 0);
      if (view().screen == Screen::selection) command(Command::Kind::push, 1);
      EXPECT_EQ(view().screen, Screen::play);
      command(Command::Kind::restart);
    }
  }
}

TEST_F(SetupTest, AChallengeChosenInTheGameIsTheOneOfItsDay) {
  set_up({.mode = Mode::challenge, .date = 20261122});
  Match day = *Match::create(challenge_of(20261122));
  const std::vector<Command> begin{{Command::Kind::push, 0}};
  day.step({input.rods, begin});
  command(Command::Kind::push, 0);
  EXPECT_EQ(view().character, day.view().character);
  EXPECT_EQ(view().next_server, day.view().next_server);
  EXPECT_EQ(view().rules, day.view().rules);
  EXPECT_EQ(view().challenge, 20261122u);
}

TEST_F(SetupTest, AChallengeKeepsTheDefaultTuning) {
  const auto tune = [&](double gravity) {
    commands.push_back(
        {Command::Kind::tune, 0, static_cast<std::uint8_t>(tuning_index("gravity")), gravity});
    step();
  };
  tune(9.0);
  set_up({.mode = Mode::challenge, .date = 20261122});
  EXPECT_EQ(view().mode, Mode::match) << "it would be another game than everybody's";
  tune(Tuning{}.gravity);
  set_up({.mode = Mode::challenge, .date = 20261122});
  EXPECT_EQ(view().mode, Mode::challenge);
  tune(9.0);
  EXPECT_TRUE(view().tuning == Tuning{});
}

TEST(Challenge, DrawsFromTheBuiltInCharactersAlone) {
  MatchDesc desc{.layout = Layout::tournament};
  Character own = desc.characters.front();
  own.name = "own";
  desc.characters.push_back(own);
  Match more = *Match::create(desc);
  for (std::uint32_t day = 20261101; day <= 20261120; ++day) {
    Match match = *Match::create(challenge_of(day));
    const std::vector<Command> again{
        {.kind = Command::Kind::set_up, .setup = {.mode = Mode::challenge, .date = day}},
        {Command::Kind::restart},
        {Command::Kind::push, 0}};
    match.step({{}, again});
    more.step({{}, again});
    ASSERT_EQ(more.view().screen, Screen::play);
    EXPECT_EQ(more.view().character, match.view().character) << day;
    const std::vector<Command> restart{{Command::Kind::restart}};
    more.step({{}, restart});
  }
}

// --- determinism ---------------------------------------------------------------------------------

// A match in which people change the game on every screen.
std::vector<Command> commands_at(int tick) {
  using Kind = Command::Kind;
  switch (tick) {
    case 100:
      return {{.kind = Kind::set_up, .setup = {.goals = 2, .match_ms = 60'000}}};
    case 200:
    case 2600:
    case 4100:
      return {{Kind::push, 0}};
    case 300:
      return {{.kind = Kind::set_up, .setup = {.rules = RuleSet::itsf, .goals = 1, .sets = 3}}};
    case 400:
    case 2700:
      return {{Kind::push, 0}, {Kind::push, 1}};
    case 1500:
      return {{.kind = Kind::set_up, .setup = {.mode = Mode::training}}};
    case 2500:
    case 4000:
      return {{Kind::restart}};
    case 3000:
      return {{.kind = Kind::set_up, .setup = {.mode = Mode::challenge, .date = 20261122}}};
    default:
      return {};
  }
}

TEST(SetupReplay, AMatchInWhichTheGameChangedIsReplayedToTheBitAlsoFromASaveAnywhere) {
  const MatchDesc desc{.layout = Layout::tournament, .seed = 3};
  constexpr int kTicks = 6000;
  Match live = *Match::create(desc);
  ComputerPlayer home({.team = 0, .seed = 1}), away({.team = 1, .seed = 2});
  std::vector<RodTargets> inputs;
  const std::vector<int> middles{50, 250, 1600, 2550, 3500, 5000};
  std::vector<std::vector<std::byte>> saved(middles.size());
  std::set<std::pair<Mode, bool>> seen;
  for (int tick = 0; tick < kTicks; ++tick) {
    for (std::size_t i = 0; i < middles.size(); ++i)
      if (tick == middles[i]) live.snapshot(saved[i]);
    TickInput input;
    home.play(live.view(), input.rods);
    away.play(live.view(), input.rods);
    inputs.push_back(input.rods);
    const auto commands = commands_at(tick);
    input.commands = commands;
    live.step(input);
    seen.insert({live.view().mode, live.view().setup_waits});
  }
  EXPECT_EQ(seen.size(), 5u) << "three modes, two of them with another that waits";
  EXPECT_EQ(live.view().mode, Mode::challenge);
  for (std::size_t i = 0; i <= middles.size(); ++i) {
    Match replayed = *Match::create(desc);
    int tick = 0;
    if (i < middles.size()) {
      const auto restored = replayed.restore(saved[i]);
      ASSERT_TRUE(restored) << restored.error().message;
      tick = middles[i];
    }
    for (; tick < kTicks; ++tick) {
      const auto commands = commands_at(tick);
      replayed.step({inputs[static_cast<std::size_t>(tick)], commands});
    }
    EXPECT_EQ(replayed.state_hash(), live.state_hash()) << i;
    EXPECT_EQ(replayed.view().setup, live.view().setup);
  }
}

TEST_F(SetupTest, ASavedMatchWithRulesThatCannotBePlayedIsRefused) {
  std::vector<std::byte> bytes;
  match->snapshot(bytes);
  MatchState state;
  auto world = std::make_unique<TableWorld>(desc.layout, bodies_of(desc, state), state.first);
  ASSERT_TRUE(load_match(desc, bytes, state, world));
  for (Game MatchState::*game : {&MatchState::game, &MatchState::next}) {
    MatchState bad = state;
    (bad.*game).rules.goals_to_win = 0;
    bytes.clear();
    save_match(desc, bad, *world, bytes);
    EXPECT_FALSE(match->restore(bytes));
  }
}

}  // namespace
}  // namespace foosball
