// Evaluates lanes: where a ball goes that is played along a slope, past which men, and what that is
// worth. Plain geometry of what the player sees, in its team's frame (computer_sight.h); no
// simulation.
#pragma once

#include "computer_sight.h"

namespace foosball {

// The player's assumptions about a lane.
struct LaneView {
  int team = 0;
  int from_rod = 0;                        // index into TableSpec::rods; it does not block itself
  std::array<double, kTeams> half_foot{};  // [m]
  double slope_error = 0.05;               // standard deviation of the ball's slope
  bool hops = false;                       // the ball hops, and then meets men whose feet are up
  // As in Judgment.
  double risk_cost = 1.0, feet_stay_up = 0.2, far_worth = 0.10;
};

// Passage of a ball along dy/dx = slope past the men in its path, up to the distance run [m].
struct LanePassage {
  double free = 1.0;  // probability that no man meets it
  double cost = 0.0;  // of the men who may meet it: the closer to its own goal it would come back,
                      // the further below 0
};
LanePassage pass_men(const TableSpec& table, const Sighting& now, const LaneView& view,
                     double slope, double run);

// Probability that a ball along dy/dx = slope ends in the goal if no man meets it.
double scoring(const TableSpec& table, const Sighting& now, const LaneView& view, double slope);

// Expected value of a ball played from its current position along dy/dx = slope: 1 for a goal, less
// with men in the way, below 0 if it would come back towards the player's own goal.
double lane_worth(const TableSpec& table, const Sighting& now, const LaneView& view, double slope);

}  // namespace foosball
