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
  // A wall takes away speed and says nothing of the spin: passes go straight.
  const double wall = 0.5 * table.width - table.ball_radius - 0.01;
  const double y = now.ball.y + slope * run;
  if (std::fabs(y) > wall) return plan;
  LaneView lanes = view.lanes;
  lanes.slope_error = 0.02 + 1.5 * lanes.slope_error;  // what a soft ball loses on its way
  const LanePassage passage = pass_men(table, now, lanes, slope, run - 0.02);
  if (passage.free < view.sure) return plan;  // a ball given away is worse than none played
  const double time = run / view.speed;
  constexpr double kReacts = 0.03;  // [s] of that the hand is not on its way yet
  const double reach = view.hand * std::max(0.0, time - kReacts);
  double nearest = 1e9;
  for (int man = 0; man < to.men; ++man) {
    const double slide = y - man_offset(to, man);
    const double way = std::fabs(slide - now.slide[static_cast<std::size_t>(view.to_rod)]);
    if (std::fabs(slide) > to.slide_limit || way >= nearest) continue;
    nearest = way;
    plan.man = man;
  }
  if (plan.man < 0) return plan;
  const double spread = 0.004 + view.lanes.slope_error * run;
  const double meets = std::clamp(0.5 + (reach - nearest) / (3.0 * spread), 0.0, 1.0);
  plan.rod = view.to_rod;
  plan.y = y;
  plan.worth = passage.cost + passage.free * meets * view.value;
  // From a serve: one that is missed must not go on into the goal, which would be a foul and gives
  // the ball away: half a goal. Of few passes is it sure that they meet their man: the share that
  // is counted as missed is no less than two in five, with which level 3 played none in 318 serves.
  constexpr double kFoul = 0.5, kMissed = 0.4;
  if (!now.goal_counts) {
    plan.worth -= kFoul * std::max(kMissed, 1.0 - meets) * scoring(table, now, lanes, slope);
  }
  return plan;
}

}  // namespace foosball
