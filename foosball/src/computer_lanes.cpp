#include "computer_lanes.h"

#include <algorithm>
#include <cmath>

namespace foosball {
namespace {

constexpr double kFeetUp = 0.9;  // |swing| beyond which a rolling ball passes below the sole [rad]

// Probability that an error with this spread [m] stays below the margin [m]. A linear approximation
// of the normal distribution.
double within(double margin, double spread) {
  return std::clamp(0.5 + margin / (3.0 * spread), 0.0, 1.0);
}

}  // namespace

LanePassage pass_men(const TableSpec& table, const Sighting& now, const LaneView& view,
                     double slope, double run) {
  const double goal_line = 0.5 * table.length;
  LanePassage passage;
  // In the order in which the ball passes the rods.
  for (int k = 0; k < kRods; ++k) {
    const int rod = view.team == 0 ? k : kRods - 1 - k;
    const RodSpec& spec = table.rods[rod];
    const double distance = attack_sign(view.team) * spec.x - now.ball.x;
    if (rod == view.from_rod || distance < 0.04 || distance > run) continue;
    const bool up = !view.hops && std::fabs(within_half_turn(now.swing[rod])) > kFeetUp;
    if (up && spec.team == view.team) continue;
    const double y = y_after(table, now.ball.y, slope, distance);
    double clearance = 1.0;
    for (int man = 0; man < spec.men; ++man) {
      clearance = std::min(clearance, std::fabs(man_offset(spec, man) + now.slide[rod] - y));
    }
    clearance -= view.half_foot[spec.team] + table.ball_radius;
    double free = within(clearance, 0.004 + view.slope_error * distance);
    if (up) free += view.feet_stay_up * (1.0 - free);
    const double blocked = passage.free * (1.0 - free);
    // The nearer the man, the faster and the less expected the rebound.
    const double near = std::clamp(1.0 - distance / 0.5, 0.0, 1.0);
    const double to_own_goal = now.ball.x + goal_line;
    const double danger = std::clamp(1.2 - to_own_goal, 0.1, 1.0);
    passage.cost -= view.risk_cost * blocked * (0.05 + 0.25 * near * danger);
    passage.free *= free;
  }
  return passage;
}

double scoring(const TableSpec& table, const Sighting& now, const LaneView& view, double slope) {
  const double run = 0.5 * table.length - now.ball.x;
  const double y = y_after(table, now.ball.y, slope, run);
  const double inside = 0.5 * table.goal_width - table.ball_radius - std::fabs(y);
  return within(inside, 0.004 + view.slope_error * run);
}

double lane_worth(const TableSpec& table, const Sighting& now, const LaneView& view, double slope) {
  const double goal_line = 0.5 * table.length;
  const double run = goal_line - now.ball.x;
  const LanePassage men = pass_men(table, now, view, slope, run);
  const double scores = scoring(table, now, view, slope);
  const double goal = now.goal_counts ? 1.0 : 0.0;
  return men.cost + men.free * (scores * goal + (1.0 - scores) * view.far_worth);
}

}  // namespace foosball
