// What level and style make of a computer player: a person's limits, and what it prefers.
#pragma once

#include <cstdint>

#include "computer_hand.h"
#include "foosball/computer_player.h"
#include "foosball/judgment.h"

namespace foosball {

struct Temperament {
  // A person's limits.
  double delay;        // from sight to hand [s]
  double hand_travel;  // to let go of a rod and grip another [s]
  double aim_error;    // standard deviation of a foot's place at the hit [m]
  AxisLimits slide, swing;
  AxisLimits strike;  // of the foot at full power

  // Thought.
  double pause_low, pause_high;  // thought spent with the foot drawn back [s]

  // World ticks for each tick of play that go into a forecast of the ball (computer_forecast.h);
  // 0: a coarse model's guess instead.
  int forecast_ticks;

  // Style.
  bool stays_home;  // both hands at the goal whenever the ball is the opponent's

  Judgment judgment;
};

Temperament temperament_of(int level, PlayStyle style);
// Differs where one of its numbers does.
std::uint64_t digest(const Temperament& t);

}  // namespace foosball
