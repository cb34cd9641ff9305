// What level and style make of a computer player: a person's limits, how far it thinks ahead, and
// what it prefers.
#pragma once

#include "computer_hand.h"
#include "foosball/computer_player.h"

namespace foosball {

struct Temperament {
  // A person's limits.
  double delay;         // from sight to hand [s]
  double hand_travel;   // to let go of a rod and grip another [s]
  int hands;            // 2; a mouse is 1
  double aim_error;     // standard deviation of a foot's place at the hit [m]
  double timing_error;  // standard deviation of a strike's instant [s]
  AxisLimits slide, swing;
  double strike_rate;          // of the foot at full power [rad/s]
  double strike_acceleration;  // [rad/s^2]

  // Thought. The ticks are those of an imagined table, a tick of play.
  int think_ticks;  // 0: aims by eye, looks no further
  int strokes;      // most strokes compared before one is chosen
  int trials;       // of each of the best, with its own motor noise

  // Style.
  double pause_low, pause_high;  // thought spent with the foot drawn back [s]
  double shot_bar;               // worth of a stroke (Foresight) that is played at once ...
  double patience;               // ... until the bar has sunk to nothing [s]
  double pass_worth;             // of a ball that the attack rod can play on
  double keep_worth;             // of a ball that stays with this rod
  double loss_cost;              // of a ball that the opponent can play
  double feint;                  // probability of a feint before a stroke
  bool stays_home;               // both hands at the goal whenever the ball is the opponent's
  bool slide_shots;              // push and pull shots
};

Temperament temperament_of(int level, PlayStyle style);

}  // namespace foosball
