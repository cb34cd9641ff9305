// Estimates the current state of the ball from a view that is a reaction time old: a human player
// also acts on expectation. It is a coarse model of the table in a team's frame (computer_sight.h):
// free flight, floor, walls, and the hanging feet of the team's own men. It ignores the opponent's
// men, who have moved since they were seen.
#pragma once

#include "computer_sight.h"
#include "foosball/tuning.h"

namespace foosball {

struct BallGuess {
  vp::Vec3 position, velocity;  // [m], [m/s]
};

struct GuessModel {
  const TableSpec* table = nullptr;
  int team = 0;                            // whose frame is used
  std::array<double, kTeams> half_foot{};  // [m]
};

// The ball after a time [s]. The rods of the sighting stand still meanwhile.
BallGuess advance(const GuessModel& model, const Tuning& tuning, const Sighting& rods,
                  const BallGuess& from, double time);

}  // namespace foosball
