#include "computer_pass.h"

#include <algorithm>
#include <cmath>

namespace foosball {

PassPlan pass_along(const TableSpec& table, const Sighting& now, const PassView& view,
                    double slope) {
  PassPlan plan;
  const int team = view.lanes.team;
  const RodSpec& to = table.rods[static_cast<std::size_t>(view.to_rod)];
  const double run = attack_sign(team) * to.x - now.ball.x;
  // A wall takes speed, and its effect on the spin is unknown: passes go straight.
  const double wall = 0.5 * table.width - table.ball_radius - 0.01;
  const double y = now.ball.y + slope * run;
  if (std::fabs(y) > wall) return plan;
  LaneView lanes = view.lanes;
  lanes.slope_error = 0.02 + 1.5 * lanes.slope_error;  // scatter of a soft ball
  const LanePassage passage = pass_men(table, now, lanes, slope, run - 0.02);
  if (passage.free < view.sure) return plan;  // losing the ball is worse than not passing
  const double time = run / view.speed;
  constexpr double kReacts = 0.03;  // [s], time before the receiver's hand moves
  const double reach = view.hand * std::max(0.0, time - kReacts);
  double nearest = 1e9;
  for (int man = 0; man < to.men; ++man) {
    const double slide = y - man_offset(to, man);
    const double distance = std::fabs(slide - now.slide[static_cast<std::size_t>(view.to_rod)]);
    if (std::fabs(slide) > to.slide_limit || distance >= nearest) continue;
    nearest = distance;
    plan.man = man;
  }
  if (plan.man < 0) return plan;
  const double spread = 0.004 + view.lanes.slope_error * run;
  const double meets = std::clamp(0.5 + (reach - nearest) / (3.0 * spread), 0.0, 1.0);
  plan.rod = view.to_rod;
  plan.y = y;
  plan.worth = passage.cost + passage.free * meets * view.value;
  // From a serve, a pass that misses must not enter the goal: that is a foul and loses the ball,
  // rated as half a goal. Few passes are certain, so the probability of a miss counts as at least
  // two in five. With it level 3 sent none into the goal in 318 serves.
  constexpr double kFoul = 0.5, kMissed = 0.4;
  if (!now.goal_counts) {
    plan.worth -= kFoul * std::max(kMissed, 1.0 - meets) * scoring(table, now, lanes, slope);
  }
  return plan;
}

}  // namespace foosball
