// Where the ball is now, guessed from what was seen a reaction time ago: a person who plays does
// not follow what he sees but what he expects. A coarse model of the table, in a team's frame
// (computer_sight.h): free flight, floor, walls, and the feet of the own men that hang down: where
// the others' were seen, they are no more.
#pragma once

#include "computer_sight.h"
#include "foosball/tuning.h"

namespace foosball {

struct BallGuess {
  vp::Vec3 position, velocity;  // [m], [m/s]
};

struct GuessModel {
  const TableSpec* table = nullptr;
  int team = 0;                            // whose frame it is
  std::array<double, kTeams> half_foot{};  // [m]
};

// The ball after a time [s] among the rods of the sighting, which stand still meanwhile.
BallGuess advance(const GuessModel& model, const Tuning& tuning, const Sighting& rods,
                  const BallGuess& from, double time);

}  // namespace foosball
