#include "referee.h"

#include <cmath>

namespace foosball {
namespace {

// A ball that stays within this distance is almost at rest, or rocks to and fro between two men.
constexpr double kHere = 0.08;  // [m]

// ITSF: how long a ball may be held on the 5-rod and on any other.
constexpr double kPossessionMidfield = 10.0;  // [s]
constexpr double kPossession = 15.0;          // [s]

// How far fore and aft of its axis a man can touch a resting ball: the foot at 40 degrees reaches
// 54 mm, its edge then 30 mm above the field, where the ball is still 12 mm thick on each side.
constexpr double kReach = 0.060;  // [m]

double seconds(std::uint64_t ticks) {
  return static_cast<double>(ticks) * kTick;
}

bool in_goal(const TableSpec& table, const vp::Vec3& ball) {
  return std::fabs(ball.y) < 0.5 * table.goal_width && ball.z < table.goal_height && ball.z > 0.0;
}

bool midfield_holds(const TableSpec& table, double x) {
  for (const RodSpec& rod : table.rods) {
    if (rod.line == Line::midfield && std::fabs(x - rod.x) < kReach) return true;
  }
  return false;
}

}  // namespace

std::optional<int> goal_by(const TableSpec& table, const vp::Vec3& ball) {
  const double past = std::fabs(ball.x) - 0.5 * table.length;
  if (past < table.ball_radius || !in_goal(table, ball)) return std::nullopt;
  return ball.x < 0.0 ? 1 : 0;
}

bool out_of_table(const TableSpec& table, const vp::Vec3& ball) {
  if (ball.z < 0.0 || std::fabs(ball.y) > 0.5 * table.width) return true;
  if (std::fabs(ball.x) <= 0.5 * table.length) return false;
  return !in_goal(table, ball) || std::fabs(ball.x) > 0.5 * table.length + table.goal_depth;
}

std::optional<int> winner(const Rules& rules, const std::array<int, kTeams>& score) {
  const int leader = score[0] >= score[1] ? 0 : 1;
  const int lead = score[leader] - score[opponent(leader)];
  const bool by_two = score[leader] >= rules.goals_to_win && lead >= 2;
  const bool at_most = score[leader] >= rules.max_goals && lead >= 1;
  return by_two || at_most ? std::optional(leader) : std::nullopt;
}

int rod_for_dead_ball(const TableSpec& table, double ball_x, int last_server) {
  const auto rods0 = rods_of_team(table, 0);
  const auto rods1 = rods_of_team(table, 1);
  constexpr int kDefence = static_cast<int>(Line::defence);
  constexpr int kMidfield = static_cast<int>(Line::midfield);
  if (ball_x < table.rods[rods0[kMidfield]].x) return rods0[kDefence];
  if (ball_x > table.rods[rods1[kMidfield]].x) return rods1[kDefence];
  return (last_server == 0 ? rods0 : rods1)[kMidfield];
}

void DeadBallWatch::reset(const vp::Vec3& ball) {
  anchor_ = ball;
  ticks_here_ = 0;
  ticks_untouched_ = 0;
}

bool DeadBallWatch::update(const TableSpec& table, const Rules& rules, const vp::Vec3& ball,
                           bool touched) {
  if (vp::norm(ball - anchor_) > kHere) reset(ball);
  ++ticks_here_;
  ticks_untouched_ = touched ? 0 : ticks_untouched_ + 1;
  const double possession = midfield_holds(table, ball.x) ? kPossessionMidfield : kPossession;
  return seconds(ticks_untouched_) >= rules.dead_ball_seconds || seconds(ticks_here_) >= possession;
}

}  // namespace foosball
