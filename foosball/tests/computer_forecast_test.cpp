// The forecast of the current ball from a delayed view.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdio>
#include <vector>

#include "../src/computer_forecast.h"
#include "../src/computer_sight.h"
#include "foosball/computer_player.h"
#include "match_fixture.h"
#include "percentile.h"

namespace foosball {
namespace {

constexpr int kDelay = 80;  // ticks
constexpr int kMax = 8;     // world steps per tick of play

// An observer of a match between two computer players, with the view of the first.
struct Watched {
  explicit Watched(Layout layout, std::uint64_t seed = 1)
      : match(*Match::create({.layout = layout, .seed = seed, .rules = {}})),
        home({.team = 0, .seed = 2 * seed, .player = *parse_player("5")}),
        away({.team = 1, .seed = 2 * seed + 1, .player = *parse_player("5")}) {}

  void look() {
    const MatchView& view = match.view();
    sight.look(view);
    forecast.set_table(view.layout, view.bodies, view.tuning);
    if (view.screen != Screen::play) return forecast.forget();
    forecast.see(sight.seen());
  }
  void play() {
    home.play(match.view(), input.rods);
    away.play(match.view(), input.rods);
    forecast.act(input.rods, kAllRods);
    match.step(input);
  }

  Match match;
  ComputerPlayer home, away;
  ComputerSight sight{0, kDelay};
  BallForecast forecast{0, kDelay, kMax};
  TickInput input;
};

class ComputerForecast : public testing::TestWithParam<Layout> {};
INSTANTIATE_TEST_SUITE_P(Layouts, ComputerForecast,
                         testing::Values(Layout::paper, Layout::tournament));

// In half of all ticks the ball does what the simulation predicts, including dribbles and strokes
// by own feet. The actions of the opponent's feet are not known.
TEST_P(ComputerForecast, IsCloserToTheBallThanACoarseModel) {
  Watched game(GetParam());
  const TableSpec& table = table_spec(GetParam());
  std::vector<double> off, coarse_off;
  long in_play = 0;
  for (int tick = 0; tick < 60'000; ++tick) {
    game.look();
    const MatchView& view = game.match.view();
    const Sighting& seen = game.sight.seen();
    if (view.screen == Screen::play && view.ball_in_play) {
      ++in_play;
      if (const auto ball = game.forecast.ball()) {
        off.push_back(1e3 * vp::norm(ball->position - view.ball_position));
        const GuessModel model{&table, 0, {0.012, 0.012}};
        const BallGuess guess =
            advance(model, view.tuning, seen, {seen.ball, seen.velocity}, seen.age);
        coarse_off.push_back(1e3 * vp::norm(guess.position - view.ball_position));
      }
    }
    game.play();
  }
  ASSERT_GT(in_play, 20'000);
  const double share = static_cast<double>(off.size()) / static_cast<double>(in_play);
  const double half = percentile(off, 0.5), max = percentile(off, 0.9);
  const double coarse_half = percentile(coarse_off, 0.5), coarse_max = percentile(coarse_off, 0.9);
  std::printf(
      "forecast in %.0f %% of play: off by %.2f mm (median), %.1f mm (90th percentile); "
      "the coarse model %.2f, %.1f\n",
      100.0 * share, half, max, coarse_half, coarse_max);
  EXPECT_GT(share, 0.5);
  EXPECT_LT(half, 0.3 * coarse_half);
  EXPECT_LT(max, 0.7 * coarse_max);
}

TEST_P(ComputerForecast, SpendsNoMoreTicksThanItMay) {
  Watched game(GetParam(), 3);
  int max = 0;
  long spent = 0, in_play = 0;
  for (int tick = 0; tick < 30'000; ++tick) {
    game.look();
    game.play();
    max = std::max(max, game.forecast.ticks_spent());
    if (game.match.view().ball_in_play) {
      ++in_play;
      spent += game.forecast.ticks_spent();
    }
  }
  std::printf("%.2f world ticks for a tick of play, %d at most\n",
              static_cast<double>(spent) / static_cast<double>(in_play), max);
  EXPECT_LE(max, kMax);
  EXPECT_GT(max, kMax / 2) << "it does catch up";
}

}  // namespace
}  // namespace foosball
