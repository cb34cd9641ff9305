#include "computer_level.h"

#include <algorithm>
#include <array>

namespace foosball {
namespace {

// By level. Delay: simple reactions to what is seen take 0.18 to 0.25 s; practised players act on
// what they expect, which the sight's guess of the ball stands for.
struct LevelRow {
  double delay, hand_travel, aim_error, timing_error;
  AxisLimits slide, swing;
  double strike_rate, strike_acceleration;
  int think_ticks, strokes, trials;
  double pause_low, pause_high;
};
constexpr std::array<LevelRow, kLevels> kRows{{
    {0.30, 0.45, 0.0090, 0.014, {0.6, 9}, {9, 180}, 40, 1400, 0, 0, 0, 0.45, 1.10},
    {0.24, 0.35, 0.0060, 0.010, {0.9, 15}, {12, 320}, 60, 2500, 0, 0, 0, 0.30, 0.80},
    {0.19, 0.28, 0.0040, 0.007, {1.3, 23}, {17, 480}, 85, 4500, 10, 16, 1, 0.20, 0.55},
    {0.15, 0.22, 0.0025, 0.005, {1.8, 34}, {22, 700}, 105, 7000, 16, 28, 1, 0.12, 0.40},
    {0.11, 0.16, 0.0015, 0.003, {2.3, 48}, {26, 950}, 122, 9500, 24, 48, 2, 0.08, 0.30},
}};

}  // namespace

Temperament temperament_of(int level, PlayStyle style) {
  const LevelRow& row = kRows.at(static_cast<std::size_t>(std::clamp(level, 1, kLevels) - 1));
  Temperament t{.delay = row.delay,
                .hand_travel = row.hand_travel,
                .hands = 2,
                .aim_error = row.aim_error,
                .timing_error = row.timing_error,
                .slide = row.slide,
                .swing = row.swing,
                .strike_rate = row.strike_rate,
                .strike_acceleration = row.strike_acceleration,
                .think_ticks = row.think_ticks,
                .strokes = row.strokes,
                .trials = row.trials,
                .pause_low = row.pause_low,
                .pause_high = row.pause_high,
                .shot_bar = 0.30,
                .patience = 0.8,
                .pass_worth = 0.25,
                .keep_worth = 0.05,
                .loss_cost = 0.10,
                .feint = 0.05 * level,
                .stays_home = false,
                .slide_shots = level >= 3};
  switch (style) {
    case PlayStyle::wall:
      t.stays_home = true;
      t.loss_cost = 0.25;
      t.shot_bar = 0.15;
      break;
    case PlayStyle::shooter:
      t.shot_bar = 0.15;
      t.pass_worth = 0.10;
      t.patience = 0.4;
      t.feint *= 0.3;
      break;
    case PlayStyle::passer:
      t.pass_worth = 0.40;
      break;
    case PlayStyle::gambler:
      t.shot_bar = 0.50;
      t.patience = 1.4;
      t.loss_cost = 0.03;
      t.feint *= 2.0;
      break;
  }
  return t;
}

}  // namespace foosball
