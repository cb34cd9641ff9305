#include "computer_level.h"

#include <algorithm>
#include <array>

namespace foosball {
namespace {

// By level. Delay: the time of simple visual reactions is 0.18 to 0.25 s. Practised players act on
// expectation, which the extrapolation of the ball models.
struct LevelRow {
  double delay, hand_travel, aim_error;
  AxisLimits slide, swing, strike;
  double pause_low, pause_high;
  int forecast_ticks;
};
constexpr std::array<LevelRow, kLevels> kRows{{
    {0.37, 0.50, 0.0095, {0.45, 6}, {10, 220}, {40, 1500}, 0.20, 0.55, 0},
    {0.21, 0.27, 0.0040, {1.0, 17}, {15, 420}, {65, 3500}, 0.10, 0.30, 0},
    {0.16, 0.22, 0.0025, {1.4, 26}, {20, 600}, {80, 5500}, 0.06, 0.20, 0},
    {0.12, 0.18, 0.0014, {2.0, 42}, {26, 850}, {95, 8000}, 0.05, 0.18, 0},
    {0.08, 0.12, 0.0006, {2.8, 65}, {34, 1250}, {112, 10000}, 0.02, 0.08, 8},
}};

}  // namespace

Temperament temperament_of(int level, PlayStyle style) {
  const LevelRow& row = kRows.at(static_cast<std::size_t>(std::clamp(level, 1, kLevels) - 1));
  return {.delay = row.delay,
          .hand_travel = row.hand_travel,
          .aim_error = row.aim_error,
          .slide = row.slide,
          .swing = row.swing,
          .strike = row.strike,
          .pause_low = row.pause_low,
          .pause_high = row.pause_high,
          .forecast_ticks = row.forecast_ticks,
          .stays_home = style == PlayStyle::wall,
          .judgment = judgment_of(level, style)};
}

Judgment judgment_of(int level, PlayStyle style) {
  Judgment j;
  j.feint = 0.04 * level;
  switch (style) {
    case PlayStyle::wall:
      j.pass_value = 0.05;
      j.risk_cost = 3.0;
      break;
    case PlayStyle::shooter:
      j.shot_bar = 0.15;
      j.patience = 0.5;
      j.feint = 0.0;
      j.pass_value = 0.02;
      break;
    case PlayStyle::passer:
      j.clear_power = 0.5;
      j.pass_value = 0.60;
      j.shot_bar = 0.35;
      break;
    case PlayStyle::gambler:
      j.pass_value = 0.02;
      j.shot_bar = 0.50;
      j.patience = 1.3;
      j.risk_cost = 0.3;
      j.feint = 0.5;
      break;
  }
  if (level == kLevels) {  // from screening with the forecast (decision 0052)
    j.tame_approach = 0.40;
    j.turn_wait = 0.24;
    j.hands_attack = 0.26;
    j.hands_loose = 0.11;
  }
  return j;
}

}  // namespace foosball
