// Evaluates passes: which man of the team's next rod can meet a ball that is played softly along a
// slope, and what that is worth. Plain geometry of what the player sees, in its team's frame
// (computer_sight.h).
#pragma once

#include "computer_lanes.h"

namespace foosball {

struct PassPlan {
  int rod = -1, man = -1;  // the receiver; rod: index into TableSpec::rods; -1: none
  double y = 0.0;          // where he meets it [m]
  double worth = -1e9;     // in the units of lane_worth()
};

struct PassView {
  LaneView lanes;
  int to_rod = -1;     // index into TableSpec::rods, ahead of lanes.from_rod
  double speed = 2.0;  // of the ball [m/s]
  double hand = 1.0;   // speed of the receiver's hand [m/s]
  double sure = 0.75;  // probability from which the lane counts as free
  double value = 0.3;  // of the ball at the receiver's foot
};

PassPlan pass_along(const TableSpec& table, const Sighting& now, const PassView& view,
                    double slope);

}  // namespace foosball
