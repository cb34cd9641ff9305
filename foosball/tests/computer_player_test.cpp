// Computer players by name, and their limits: those of a person with two hands.
#include "foosball/computer_player.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <deque>
#include <string>
#include <utility>
#include <vector>

#include "../src/computer_hands.h"
#include "../src/computer_level.h"
#include "foosball/statistics.h"
#include "match_fixture.h"

namespace foosball {
namespace {

TEST(ParsePlayer, TakesLevelsStylesAndReferencesAndWritesThemAgain) {
  for (const char* text : {"1", "2", "3", "4", "5", "3:shooter", "5:wall", "1:gambler", "2:passer",
                           "classic:0.9", "classic:0"}) {
    const auto spec = parse_player(text);
    ASSERT_TRUE(spec) << text;
    EXPECT_EQ(to_text(*spec), text);
  }
  EXPECT_EQ(parse_player("4")->style, style_of_level(4));
  EXPECT_EQ(*parse_player("classic"), *parse_player("classic:0.6"));
}

TEST(ParsePlayer, RefusesAnythingElseWithASentenceThatNamesTheChoices) {
  for (const char* text :
       {"", "0", "6", "3:", "3:keeper", "33", "-1", "classic:", "classic:2", "classic:0.9.1",
        "classic:1e0", "mouse:2", " 3", "3 ", "Classic", "classic:-0.5", "classic:."}) {
    const auto spec = parse_player(text);
    ASSERT_FALSE(spec) << text;
    EXPECT_EQ(spec.error().code, vp::Errc::invalid_argument);
    EXPECT_NE(spec.error().message.find("gambler"), std::string::npos);
  }
}

TEST(ComputerHands, AHandThatLeavesARodHoldsTheNextOnlyAfterItsWay) {
  ComputerHands hands(2, 100);
  hands.want(1, 0, {});
  for (int tick = 0; tick < 99; ++tick) hands.pass_time();
  EXPECT_FALSE(hands.holds(1));
  hands.pass_time();
  EXPECT_TRUE(hands.holds(1) && hands.holds(0));
  hands.want(2, 1, {});
  EXPECT_TRUE(hands.holds(1)) << "wanted again: stays";
  EXPECT_FALSE(hands.holds(0)) << "gone to the midfield";
  EXPECT_FALSE(hands.holds(2));
  for (int tick = 0; tick < 100; ++tick) hands.pass_time();
  EXPECT_TRUE(hands.holds(2));
  hands.want(3, 0, {false, false, true, false});
  EXPECT_TRUE(hands.holds(2)) << "busy with a stroke";
  EXPECT_FALSE(hands.holds(1));
}

TEST(Temperament, HigherLevelsAreBetterInEverythingButNoBetterThanAPerson) {
  for (int level = 2; level <= kLevels; ++level) {
    const Temperament lower = temperament_of(level - 1, PlayStyle::passer);
    const Temperament t = temperament_of(level, PlayStyle::passer);
    EXPECT_LT(t.delay, lower.delay);
    EXPECT_LT(t.hand_travel, lower.hand_travel);
    EXPECT_LT(t.aim_error, lower.aim_error);
    EXPECT_GT(t.slide.rate, lower.slide.rate);
    EXPECT_GT(t.strike.rate, lower.strike.rate);
  }
  const Temperament best = temperament_of(kLevels, PlayStyle::gambler);
  EXPECT_GE(best.delay, 0.08);
  EXPECT_GE(best.hand_travel, 0.12);
  EXPECT_LE(best.strike.rate, 140.0);
}

TEST(PlayersDigest, TellsEveryNumberOfEveryLevel) {
  for (int level = 1; level <= kLevels; ++level) {
    for (int style = 0; style < kPlayStyles; ++style) {
      const Temperament t = temperament_of(level, static_cast<PlayStyle>(style));
      const std::uint64_t is = digest(t);
      EXPECT_EQ(is, digest(temperament_of(level, static_cast<PlayStyle>(style))));
      const auto differs = [&](auto change) {
        Temperament other = t;
        change(other);
        return digest(other) != is;
      };
      EXPECT_TRUE(differs([](Temperament& o) { o.delay += 1e-3; }));
      EXPECT_TRUE(differs([](Temperament& o) { o.hand_travel += 1e-9; }));
      EXPECT_TRUE(differs([](Temperament& o) { o.aim_error += 1e-9; }));
      EXPECT_TRUE(differs([](Temperament& o) { o.slide.acceleration += 1.0; }));
      EXPECT_TRUE(differs([](Temperament& o) { o.swing.rate += 1.0; }));
      EXPECT_TRUE(differs([](Temperament& o) { std::swap(o.strike.rate, o.strike.acceleration); }));
      EXPECT_TRUE(differs([](Temperament& o) { std::swap(o.pause_low, o.pause_high); }));
      EXPECT_TRUE(differs([](Temperament& o) { ++o.forecast_ticks; }));
      EXPECT_TRUE(differs([](Temperament& o) { o.stays_home = !o.stays_home; }));
      for (const JudgmentField& field : kJudgmentFields) {
        EXPECT_TRUE(differs([&](Temperament& o) { o.judgment.*field.value += 1e-12; }))
            << field.name;
      }
    }
  }
  EXPECT_EQ(players_digest(), players_digest());
}

struct Pairing {
  Layout layout;
  const char* home;
  const char* away;
};
std::string pairing_name(const testing::TestParamInfo<Pairing>& info) {
  std::string name = info.param.layout == Layout::paper ? "paper_" : "tournament_";
  name.append(info.param.home).append("_").append(info.param.away);
  std::replace_if(
      name.begin(), name.end(), [](char c) { return c == ':' || c == '.'; }, '_');
  return name;
}

class ComputerPlayers : public testing::TestWithParam<Pairing> {};
INSTANTIATE_TEST_SUITE_P(All, ComputerPlayers,
                         testing::Values(Pairing{Layout::tournament, "5:shooter", "4"},
                                         Pairing{Layout::paper, "5", "3"},
                                         Pairing{Layout::tournament, "1", "2"},
                                         Pairing{Layout::paper, "2:gambler", "3:wall"}),
                         pairing_name);

// Detected from the targets: a rod has a hand if it moves, or has moved within the time that a hand
// of the best level needs to change rods.
TEST_P(ComputerPlayers, HaveTwoHandsEachAndTurnThemRoundTwiceASecondAtMost) {
  constexpr int kSeconds = 90;
  constexpr int kWay = 110;  // ticks; the fastest hand needs 120
  Match match = *Match::create({.layout = GetParam().layout, .seed = 3, .rules = {}});
  ComputerPlayer home({.team = 0, .seed = 6, .player = *parse_player(GetParam().home)});
  ComputerPlayer away({.team = 1, .seed = 7, .player = *parse_player(GetParam().away)});
  StatisticsObserver observer;
  TickInput input;
  RodTargets before = input.rods;
  const TableSpec& table = table_spec(GetParam().layout);
  std::array<int, kRods> moved{};
  moved.fill(-1000);
  double swing = 0.0;
  int in_play = 0;
  for (int tick = 0; tick < kSeconds * 1000; ++tick) {
    home.play(match.view(), input.rods);
    away.play(match.view(), input.rods);
    match.step(input);
    observer.observe(match.view(), match.events(), input.rods);
    std::array<int, kTeams> hands{};
    const bool playing = match.view().screen == Screen::play;
    in_play += match.view().ball_in_play ? 1 : 0;
    for (int rod = 0; rod < kRods; ++rod) {
      const RodTarget &now = input.rods[rod], &was = before[rod];
      if (playing && (now.slide != was.slide || now.angle != was.angle)) {
        ASSERT_TRUE(now.live) << "a rod without a hand moves";
        moved[rod] = tick;
      }
      if (!playing) moved[rod] = -1000;
      if (tick - moved[rod] < kWay) ++hands[table.rods[rod].team];
      if (match.view().ball_in_play)
        swing = std::max(swing, std::fabs(std::remainder(now.angle, 2.0 * vp::kPi)));
    }
    ASSERT_LE(std::max(hands[0], hands[1]), 2) << "tick " << tick;
    before = input.rods;
  }
  ASSERT_GT(in_play, 5000);
  EXPECT_LT(swing, 2.3) << "no rod ever spins";
  const Statistics& s = observer.totals();
  for (int team = 0; team < kTeams; ++team) {
    double reversals = 0.0;
    for (int rod = 0; rod < kRods; ++rod) {
      if (table.rods[rod].team == team) {
        reversals += static_cast<double>(s.slide_reversals[rod] + s.swing_reversals[rod]);
      }
    }
    const double each = reversals / (4.0 * kTick * static_cast<double>(s.play_ticks));
    std::printf("team %d: %.2f reversals a rod and second\n", team, each);
    EXPECT_LT(each, 2.0);
    EXPECT_EQ(s.moving_ticks[team][3] + s.moving_ticks[team][4], 0U);
  }
}

// A ball at rest in front of the goal, in front of or behind the men of a rod: the player's own
// foot never drives it into its own goal.
TEST(ComputerPlayer, NeverSwingsBackThroughABallIntoItsOwnGoal) {
  int own = 0, moved = 0;
  for (std::uint64_t seed = 1; seed <= 12; ++seed) {
    const Layout layout = seed % 2 == 0 ? Layout::paper : Layout::tournament;
    const std::string level = std::to_string(1 + seed % 5);
    Match match = *Match::create({.layout = layout, .seed = seed, .rules = {}});
    ComputerPlayer home({.team = 0, .seed = seed, .player = *parse_player(level)});
    StatisticsObserver observer;
    TickInput input;
    const Command confirms{Command::Kind::push, 1};
    for (int tick = 0; tick < 12000; ++tick) {
      home.play(match.view(), input.rods);
      const bool asked = match.view().screen == Screen::selection && !match.view().confirmed[1];
      match.step({input.rods, std::span(&confirms, asked ? 1 : 0)});
      observer.observe(match.view(), match.events(), input.rods);
      moved += vp::norm(match.view().ball_velocity) > 1.0 ? 1 : 0;
    }
    own += static_cast<int>(observer.totals().own_goals_swing[0]);
  }
  EXPECT_EQ(own, 0);
  EXPECT_GT(moved, 1000);
}

// A goal straight from a serve is a foul (ITSF 4.2.2). Even against an absent team the ball must go
// to a second man first.
TEST(ComputerPlayer, ScoresAgainstAnAbsentSideWithoutFoulsFromItsServes) {
  for (const Layout layout : {Layout::paper, Layout::tournament}) {
    for (const char* level : {"3", "5"}) {
      Match match = *Match::create({.layout = layout, .seed = 601, .rules = {}});
      ComputerPlayer home({.team = 0, .seed = 1202, .player = *parse_player(level)});
      TickInput input;
      const Command confirms{Command::Kind::push, 1};
      int goals = 0, fouls = 0, serves = 0;
      for (int tick = 0; tick < 120000; ++tick) {
        home.play(match.view(), input.rods);
        const bool asked = match.view().screen == Screen::selection && !match.view().confirmed[1];
        match.step({input.rods, std::span(&confirms, asked ? 1 : 0)});
        for (const Event& event : match.events()) {
          goals += event.kind == EventKind::goal ? 1 : 0;
          if (event.team != 0) continue;
          fouls += event.kind == EventKind::foul ? 1 : 0;
          serves += event.kind == EventKind::serve ? 1 : 0;
        }
      }
      std::printf("level %s, %s: %d goals, %d fouls from %d serves in 2 minutes\n", level,
                  layout == Layout::paper ? "paper" : "tournament", goals, fouls, serves);
      EXPECT_LE(fouls, 1);
      EXPECT_GE(goals, std::string(level) == "5" ? 2 : 0);
    }
  }
}

class RollingBall : public MatchTest {
 protected:
  RollingBall() : MatchTest(Layout::paper) {}
};

// Under a foot that is drawn back to strike, such a ball would roll on into the goal.
TEST_F(RollingBall, ThatCreepsToTheGoalIsStoppedByTheGoalie) {
  start_by_commands();
  int goals = 0;
  constexpr int kBalls = 8;
  for (int ball = 0; ball < kBalls; ++ball) {
    ComputerPlayer home({.team = 0,
                         .seed = static_cast<std::uint64_t>(ball + 1),
                         .opens_match = false,
                         .player = *parse_player("5")});
    const int before = view().score[1];
    shoot({-0.44, -0.07 + 0.02 * ball, 0.0174}, {-0.35, 0.10 - 0.03 * ball, 0.0}, 1);
    for (int tick = 0; tick < 500; ++tick) {
      home.play(view(), input.rods);
      step();
    }
    goals += view().score[1] - before;
    if (view().screen == Screen::ceremony) run(1.0);
  }
  EXPECT_LE(goals, 1) << "of " << kBalls;
}

// Men who touched it from the side with their feet down would push it towards their own goal: the
// feet must swing up first.
TEST_F(RollingBall, BehindTheGoalieIsNotPushedHome) {
  int balls = 0, pushed = 0, goals = 0;
  for (const double behind : {0.020, 0.030, 0.040, 0.050}) {
    for (const double vy : {-0.7, -0.4, 0.4, 0.7}) {
      for (const double y : {-0.12, -0.04, 0.04, 0.12}) {
        ComputerPlayer home({.team = 0,
                             .seed = static_cast<std::uint64_t>(++balls),
                             .opens_match = false,
                             .player = *parse_player("5")});
        match = std::make_unique<Match>(*Match::create(desc));
        start_by_commands();
        shoot({table().rods[0].x - behind, y, 0.0174}, {0.02, vy, 0.0}, 1);
        for (int tick = 0; tick < 900; ++tick) {
          const double before = view().ball_velocity.x;
          home.play(view(), input.rods);
          step();
          // From 0.13 s on the player has seen the ball, and a hand is on the rod.
          if (tick < 130) continue;
          for (const Event& event : match->events()) {
            pushed += event.kind == EventKind::man_hit && view().ball_velocity.x < before - 0.1;
          }
        }
        goals += view().score[1];
      }
    }
  }
  std::printf("%d balls, pushed home %d times, %d goals\n", balls, pushed, goals);
  EXPECT_LT(pushed, balls / 5);
}

// A foot that comes down to scoop such a ball must move along with it, and not land on it.
TEST_F(RollingBall, BehindTheFeetIsNotPinnedByTheFootThatScoopsIt) {
  int balls = 0, pinned = 0;
  for (const double behind : {0.035, 0.042, 0.049, 0.056}) {
    for (const double vy : {-0.16, -0.10, 0.10, 0.16}) {
      for (const double y : {-0.10, 0.0, 0.10}) {
        ComputerPlayer home({.team = 0,
                             .seed = static_cast<std::uint64_t>(++balls),
                             .opens_match = false,
                             .player = *parse_player("2")});
        match = std::make_unique<Match>(*Match::create(desc));
        start_by_commands();
        shoot({table().rods[1].x - behind, y, 0.0174}, {0.0, vy, 0.0}, 1);
        int held = 0;  // ticks in which the ball blocks a man
        for (int tick = 0; tick < 1500; ++tick) {
          home.play(view(), input.rods);
          step();
          double off = 0.0;
          for (int man = 0; man < table().rods[1].men; ++man) {
            off = std::max(off, std::fabs(view().men[1][man].angle - view().rods[1].angle));
          }
          held += off > 0.3;
        }
        pinned += held > 200;
      }
    }
  }
  std::printf("%d balls, %d pinned\n", balls, pinned);
  EXPECT_LE(pinned, balls / 8);
}

// A ball that has reversed behind the feet is not where a player with a delayed view expects it: a
// foot that is drawn back must not drive it towards its own goal.
TEST(ComputerPlayer, HardlyEverSwingsBackThroughABallThatItSeesLate) {
  int swung = 0, minutes = 0;
  for (const char* level : {"2", "3", "4"}) {
    Rules endless;
    endless.goals_to_win = endless.max_goals = kMaxScore;
    Match match = *Match::create({.layout = Layout::paper, .seed = 81, .rules = endless});
    ComputerPlayer home({.team = 0, .seed = 82, .player = *parse_player(level)});
    ComputerPlayer away({.team = 1, .seed = 83, .player = *parse_player(level)});
    const TableSpec& table = table_spec(Layout::paper);
    TickInput input;
    minutes += 4;
    for (int tick = 0; tick < 240000; ++tick) {
      home.play(match.view(), input.rods);
      away.play(match.view(), input.rods);
      const MatchView before = match.view();
      match.step(input);
      for (const Event& event : match.events()) {
        if (event.kind != EventKind::man_hit) continue;
        const double s = attack_sign(event.team);
        const double foot =
            -s * before.rods[event.rod].angle_rate * (table.rod_height - event.point.z);
        const double gain = s * (match.view().ball_velocity.x - before.ball_velocity.x);
        swung += foot < -0.5 && gain < -0.5 ? 1 : 0;
      }
    }
  }
  std::printf("%d times in %d minutes\n", swung, minutes);
  EXPECT_LE(swung, 14) << "25 where feet were always drawn back at full speed";
}

}  // namespace
}  // namespace foosball
