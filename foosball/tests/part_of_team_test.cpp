// A computer player with some rods of a team; a team mate has the others.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <string>
#include <vector>

#include "../src/computer_forecast.h"
#include "../src/computer_sight.h"
#include "foosball/computer_player.h"
#include "percentile.h"

namespace foosball {
namespace {

std::uint8_t lines_of_team(Layout layout, int team, std::initializer_list<Line> lines) {
  unsigned rods = 0;
  for (const Line line : lines) {
    rods |= 1U << rods_of_team(table_spec(layout), team)[static_cast<std::size_t>(line)];
  }
  return static_cast<std::uint8_t>(rods);
}
bool has(std::uint8_t rods, int rod) {
  return (rods >> rod & 1) != 0;
}

// Two players who share team 0, against one with all rods.
struct SharedTeam {
  SharedTeam(Layout table_layout, const std::string& player, const std::string& with,
             std::initializer_list<Line> lines, std::uint64_t seed = 1)
      : layout(table_layout),
        own(lines_of_team(layout, 0, lines)),
        match(*Match::create({.layout = layout, .seed = seed, .rules = {}})),
        home({.team = 0, .seed = 3 * seed, .player = *parse_player(player)}),
        mate({.team = 0, .seed = 3 * seed + 1, .player = *parse_player(with)}),
        away({.team = 1, .seed = 3 * seed + 2, .player = *parse_player("5")}) {}

  const MatchView& view() const { return match.view(); }
  // Commands open the match: only the opponent has all rods of its team.
  void step() {
    commands.clear();
    if (view().screen == Screen::logo || view().screen == Screen::selection) {
      commands.push_back({Command::Kind::push, 0, 0});
    }
    input.commands = commands;
    mate.play(view(), input.rods, static_cast<std::uint8_t>(~own));
    away.play(view(), input.rods);
    match.step(input);
  }

  Layout layout;
  std::uint8_t own;
  Match match;
  ComputerPlayer home, mate, away;
  TickInput input;
  std::vector<Command> commands;
};

struct Case {
  Layout layout;
  const char* player;
};
class PartOfATeam : public testing::TestWithParam<Case> {};
std::string case_name(const testing::TestParamInfo<Case>& info) {
  return std::string(info.param.player) +
         (info.param.layout == Layout::paper ? "_paper" : "_tournament");
}
INSTANTIATE_TEST_SUITE_P(All, PartOfATeam,
                         testing::Values(Case{Layout::tournament, "5"}, Case{Layout::paper, "5"},
                                         Case{Layout::tournament, "2"},
                                         Case{Layout::tournament, "classic"}),
                         case_name);

// It changes no target of other rods, and never releases its own two rods to reach for a third.
TEST_P(PartOfATeam, NeverSpendsAHandOnATeamMatesRods) {
  SharedTeam game(GetParam().layout, GetParam().player, "4", {Line::goalie, Line::defence});
  int held_for = 0, in_play = 0;
  for (int tick = 0; tick < 40'000; ++tick) {
    RodTargets targets = game.input.rods;
    for (int rod = 0; rod < kRods; ++rod) {
      if (!has(game.own, rod)) targets[rod] = {0.001 * rod, 0.3, -0.7, 4.0, rod % 2 == 0};
    }
    const RodTargets before = targets;
    game.home.play(game.view(), targets, game.own);
    bool held = true;
    for (int rod = 0; rod < kRods; ++rod) {
      if (has(game.own, rod)) {
        game.input.rods[rod] = targets[rod];
        held = held && targets[rod].live;
        continue;
      }
      ASSERT_EQ(targets[rod].slide, before[rod].slide) << "rod " << rod << ", tick " << tick;
      ASSERT_EQ(targets[rod].angle, before[rod].angle);
      ASSERT_EQ(targets[rod].slide_rate, before[rod].slide_rate);
      ASSERT_EQ(targets[rod].angle_rate, before[rod].angle_rate);
      ASSERT_EQ(targets[rod].live, before[rod].live);
    }
    const bool playing = game.view().screen == Screen::play;
    constexpr int kWay = 300;  // ticks: by then the slowest hand here is on its rod
    held_for = playing ? held_for + 1 : 0;
    if (held_for > kWay) {
      ++in_play;
      ASSERT_TRUE(held) << "tick " << tick;
    }
    game.step();
  }
  EXPECT_GT(in_play, 10'000);
}

// Its input contains the targets of other rods. It must not use them before it sees the motion.
TEST_P(PartOfATeam, PlaysTheSameWhateverIsCommandedOfTheOtherRods) {
  SharedTeam game(GetParam().layout, GetParam().player, "4", {Line::defence, Line::attack});
  ComputerPlayer again({.team = 0, .seed = 3, .player = *parse_player(GetParam().player)});
  for (int tick = 0; tick < 20'000; ++tick) {
    RodTargets other{};
    for (int rod = 0; rod < kRods; ++rod) {
      other[rod] = {0.05 * std::sin(0.01 * tick + rod), 0.01 * tick, 0.5, 10.0, true};
    }
    again.play(game.view(), other, game.own);
    game.home.play(game.view(), game.input.rods, game.own);
    for (int rod = 0; rod < kRods; ++rod) {
      if (!has(game.own, rod)) continue;
      ASSERT_EQ(other[rod].slide, game.input.rods[rod].slide) << "tick " << tick;
      ASSERT_EQ(other[rod].angle, game.input.rods[rod].angle) << "tick " << tick;
    }
    game.step();
  }
}

// Where the team mate left it, even within the distance at which a player would keep its own
// position.
TEST_P(PartOfATeam, TakesARodOverWhereTheMateLeftIt) {
  SharedTeam game(GetParam().layout, GetParam().player, "4", {Line::goalie, Line::defence});
  int taken = 0;
  for (int tick = 0; tick < 20'000; ++tick) {
    const bool all = tick % 2000 >= 1000, gains = tick % 2000 == 1000;
    RodTargets targets = game.input.rods;
    game.home.play(game.view(), targets, all ? kAllRods : game.own);
    for (int rod = 0; rod < kRods; ++rod) {
      const bool gained = gains && has(kAllRods & ~game.own, rod) && tick > 4000;
      if (gained && table_spec(game.layout).rods[rod].team == 0) {
        ++taken;
        constexpr double kStep = 0.003, kTurn = 0.12;  // motion in one tick [m], [rad]
        EXPECT_NEAR(targets[rod].slide, game.view().rods[rod].slide, kStep);
        EXPECT_NEAR(targets[rod].angle, game.view().rods[rod].angle, kTurn);
      }
      if (has(game.own, rod)) game.input.rods[rod] = targets[rod];
    }
    game.step();
  }
  EXPECT_EQ(taken, 16);
}

TEST_P(PartOfATeam, LeavesTheScreensToTheMate) {
  SharedTeam game(GetParam().layout, GetParam().player, "4", {Line::goalie, Line::midfield});
  std::vector<Command> push{{Command::Kind::push, 0, 0}};
  TickInput open{{}, push};
  game.match.step(open);
  ASSERT_EQ(game.view().screen, Screen::selection);
  RodTargets targets{};
  for (int tick = 0; tick < 5'000; ++tick) {
    game.home.play(game.view(), targets, game.own);
    game.match.step({targets, {}});
    ASSERT_FALSE(game.view().confirmed[0]) << "tick " << tick;
    ASSERT_EQ(game.view().character[0], 1) << "tick " << tick;
  }
}

// By the owner of the feet at the ball, now or at the time of the delayed view: a forecast is
// accurate where nobody interferes.
class MateForecast : public testing::TestWithParam<Layout> {};
INSTANTIATE_TEST_SUITE_P(Layouts, MateForecast, testing::Values(Layout::paper, Layout::tournament));

TEST_P(MateForecast, KnowsThatATeamMatesMenMove) {
  constexpr int kDelay = 80;  // ticks
  enum Whose { own_feet, mates, opponents };
  std::array<std::vector<double>, 3> off;  // [mm]
  for (std::uint64_t seed = 1; seed <= 3; ++seed) {
    SharedTeam game(GetParam(), "5", "5", {Line::goalie, Line::defence}, seed);
    ComputerSight sight{0, kDelay};
    BallForecast forecast{0, kDelay, 8};
    const TableSpec& table = table_spec(GetParam());
    for (int tick = 0; tick < 40'000; ++tick) {
      const MatchView& view = game.view();
      sight.look(view);
      forecast.set_table(view.layout, view.bodies, view.tuning);
      if (view.screen == Screen::play) {
        forecast.see(sight.seen());
      } else {
        forecast.forget();
      }
      const auto ball = forecast.ball();
      if (view.screen == Screen::play && view.ball_in_play && ball) {
        int nearest = 0;
        for (int rod = 1; rod < kRods; ++rod) {
          if (std::fabs(table.rods[rod].x - view.ball_position.x) <
              std::fabs(table.rods[nearest].x - view.ball_position.x))
            nearest = rod;
        }
        const Whose whose = table.rods[nearest].team == 1 ? opponents
                            : has(game.own, nearest)      ? own_feet
                                                          : mates;
        off[whose].push_back(1e3 * vp::norm(ball->position - view.ball_position));
      }
      game.home.play(view, game.input.rods, game.own);
      forecast.act(game.input.rods, game.own);
      game.step();
    }
  }
  std::array<double, 3> half{}, usual{};
  for (std::size_t whose = 0; whose < off.size(); ++whose) {
    ASSERT_GT(off[whose].size(), 3'000U);
    half[whose] = percentile(off[whose], 0.5);
    usual[whose] = percentile(off[whose], 0.75);
  }
  std::printf(
      "off at own feet %.2f mm (median), %.1f mm (75th percentile), a mate's %.2f, %.1f, "
      "an opponent's %.2f, %.1f\n",
      half[own_feet], usual[own_feet], half[mates], usual[mates], half[opponents],
      usual[opponents]);
  EXPECT_LE(half[mates], half[opponents] + 0.5);
  // 0 and 2 mm; 25 and 35 mm for a forecast with the others' men hanging still at the centre.
  EXPECT_LE(usual[mates], 10.0);
}

TEST(ComputerSight, LooksAnewAfterAnInterruption) {
  Match match = *Match::create({});
  ComputerSight sight(0, 80);
  for (int tick = 0; tick < 200; ++tick) {
    sight.look(match.view());
    match.step({});
  }
  EXPECT_NEAR(sight.seen().age, 0.079, 1e-9);
  sight.forget();
  sight.look(match.view());
  EXPECT_EQ(sight.seen().age, 0.0) << "nothing of before";
}

}  // namespace
}  // namespace foosball
