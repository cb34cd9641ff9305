// Parameters of a computer player by level and style: a person's limits, and preferences.
#pragma once

#include <cstdint>

#include "computer_hand.h"
#include "foosball/computer_player.h"
#include "foosball/judgment.h"

namespace foosball {

struct Temperament {
  // A person's limits.
  double delay;        // reaction time [s]
  double hand_travel;  // time to change from one rod to another [s]
  double aim_error;    // standard deviation of the foot's position at the hit [m]
  AxisLimits slide, swing;
  AxisLimits strike;  // of the foot at full power

  // Thinking.
  double pause_low, pause_high;  // time to think with the foot drawn back [s]

  // Steps of the forecast's worlds per tick of play (computer_forecast.h); 0: the estimate of the
  // coarse model instead.
  int forecast_ticks;

  // Style.
  bool stays_home;  // both hands stay at the goal while the opponent has the ball

  Judgment judgment;
};

Temperament temperament_of(int level, PlayStyle style);
// Changes if any of its numbers changes.
std::uint64_t digest(const Temperament& t);

}  // namespace foosball
