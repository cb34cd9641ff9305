#include "referee.h"

#include <algorithm>
#include <cmath>

namespace foosball {
namespace {

// A ball that stays within this distance is nearly at rest, or rocks between two men.
constexpr double kHere = 0.08;  // [m]
// A slower ball that no man can reach has stopped (8).
constexpr double kStopped = 0.02;        // [m/s]
constexpr double kStoppedSeconds = 1.0;  // long enough to see it

double seconds(std::uint64_t ticks) {
  return static_cast<double>(ticks) * kTick;
}

bool in_goal(const TableSpec& table, const vp::Vec3& ball) {
  return std::fabs(ball.y) < 0.5 * table.goal_width && ball.z < table.goal_height && ball.z > 0.0;
}

// The goalie's rod and the defence count as one area of possession (24).
int area_of(const RodSpec& rod) {
  const Line line = rod.line == Line::goalie ? Line::defence : rod.line;
  return rod.team * 4 + static_cast<int>(line);
}

// True between the team's goal and its defence: a ball there has not been advanced (24.1).
bool behind_defence(const TableSpec& table, int team, double x) {
  const int rod = rods_of_team(table, team)[static_cast<std::size_t>(Line::defence)];
  return attack_sign(team) * (x - table.rods[rod].x) < 0.0;
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

std::optional<int> winner(const Rules& rules, const std::array<int, kTeams>& score, bool last_set,
                          bool time_over) {
  const int leader = score[0] >= score[1] ? 0 : 1;
  const int lead = score[leader] - score[opponent(leader)];
  const int needed = last_set ? rules.lead : 1;
  const bool enough = score[leader] >= rules.goals_to_win && lead >= needed;
  const bool at_most = score[leader] >= rules.max_goals && lead >= 1;
  return enough || at_most || (time_over && lead >= 1) ? std::optional(leader) : std::nullopt;
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

int rod_after_possession(const TableSpec& table, int team, Line line) {
  const Line to = line == Line::attack ? Line::defence : Line::midfield;
  return rods_of_team(table, opponent(team))[static_cast<std::size_t>(to)];
}

// If two rods can reach the ball, it belongs to the nearer one.
int nearest_in_reach(const TableSpec& table, std::uint8_t rods_in_reach, double ball_x) {
  int nearest = kRods;
  double min = table.length;
  for (int rod = 0; rod < kRods; ++rod) {
    const double distance = std::fabs(table.rods[rod].x - ball_x);
    if ((rods_in_reach >> rod & 1) == 0 || distance >= min) continue;
    min = distance;
    nearest = rod;
  }
  return nearest;
}

void BallWatch::reset(const vp::Vec3& ball) {
  *this = {};
  anchor_ = ball;
}

BallWatch::Verdict BallWatch::update(const TableSpec& table, const Rules& rules,
                                     const Sight& sight) {
  in_reach_ = sight.rods_in_reach != 0;
  if (in_reach_) {
    const int rod = nearest_in_reach(table, sight.rods_in_reach, sight.ball.x);
    const bool advanced =
        rod_ == kRods || left_ || area_of(table.rods[rod]) != area_of(table.rods[rod_]);
    if (advanced) ticks_possessed_ = 0;
    rod_ = rod;
    left_ = false;
    count_tick(ticks_possessed_);
    ticks_unreached_ = 0;
  } else {
    left_ = left_ || rod_ == kRods || !behind_defence(table, table.rods[rod_].team, sight.ball.x);
    count_tick(ticks_unreached_);
  }
  if (vp::norm(sight.ball - anchor_) > kHere) {
    anchor_ = sight.ball;
    ticks_untouched_ = 0;
  }
  count_tick(ticks_untouched_);
  if (sight.touched) ticks_untouched_ = 0;

  const bool stopped = !in_reach_ && vp::norm(sight.velocity) < kStopped;
  count_tick(ticks_stopped_);
  if (!stopped) ticks_stopped_ = 0;
  if (!in_reach_) {
    const bool dead = seconds(ticks_stopped_) >= kStoppedSeconds ||
                      seconds(ticks_unreached_) >= rules.dead_ball_seconds;
    return dead ? Verdict::dead : Verdict::alive;
  }
  const double limit = possession_limit(rules, table.rods[rod_].line == Line::midfield);
  const bool absent = sight.absent[table.rods[rod_].team];
  const double wait =
      absent ? std::min(kAbsentStillSeconds, rules.still_seconds) : rules.still_seconds;
  const bool still = rules.still_seconds > 0.0 && seconds(ticks_untouched_) >= wait;
  return still || seconds(ticks_possessed_) >= limit ? Verdict::held : Verdict::alive;
}

}  // namespace foosball
