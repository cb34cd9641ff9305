// Where a ball would go that is played at a slope: past which men, and what comes of it. Plain
// geometry of what the player sees, in its team's frame (computer_sight.h); no simulation.
#pragma once

#include "computer_sight.h"

namespace foosball {

// What a player thinks of a lane.
struct LaneView {
  int team = 0;
  int from_rod = 0;                        // index into TableSpec::rods; not in its own way
  std::array<double, kTeams> half_foot{};  // [m]
  double slope_error = 0.05;               // standard deviation of the ball's slope
  bool hops = false;                       // the ball, which then meets men whose feet are up
  // As in Judgment.
  double risk_cost = 1.0, feet_stay_up = 0.2, far_worth = 0.10;
};

// Past the men in the way of a ball that is sent along dy/dx = slope, as far as run [m].
struct LanePassage {
  double free = 1.0;  // probability that none of them meets it
  double cost = 0.0;  // of those who may: below 0 the nearer its own goal it would come back
};
LanePassage pass_men(const TableSpec& table, const Sighting& now, const LaneView& view,
                     double slope, double run);

// Probability that a ball that nobody meets on its way along dy/dx = slope ends in the goal.
double scoring(const TableSpec& table, const Sighting& now, const LaneView& view, double slope);

// Expected worth of a ball that is sent from where it is along dy/dx = slope: 1 a goal; less where
// men are in the way, and below 0 where it would come back towards the own goal.
double lane_worth(const TableSpec& table, const Sighting& now, const LaneView& view, double slope);

}  // namespace foosball
