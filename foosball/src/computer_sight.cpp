#include "computer_sight.h"

#include <algorithm>
#include <cmath>

namespace foosball {

ComputerSight::ComputerSight(int team, int delay_ticks)
    : team_(team), seen_(static_cast<std::size_t>(std::max(1, delay_ticks))) {}

void ComputerSight::look(const MatchView& view) {
  const Sighting fresh = in_team_frame(view);
  if (fresh.ball_in_play != now_.ball_in_play) count_ = 0;  // a serve or a goal: start again
  seen_[next_] = fresh;
  next_ = (next_ + 1) % seen_.size();
  count_ = std::min(count_ + 1, seen_.size());
  const std::size_t oldest = (next_ + seen_.size() - count_) % seen_.size();
  now_ = seen_[oldest];
  const double delay = static_cast<double>(count_ - 1) * kTick;
  now_.age = delay;
  seen_now_ = now_;
  const TableSpec& table = table_spec(view.layout);
  const double end = 0.5 * table.length;
  now_.ball.x = std::clamp(now_.ball.x + delay * now_.velocity.x, -end, end);
  now_.ball.y = y_after(table, now_.ball.y, now_.velocity.y, delay);
}

Sighting ComputerSight::in_team_frame(const MatchView& view) const {
  const double s = attack_sign(team_);
  Sighting seen;
  seen.ball_in_play = view.ball_in_play;
  seen.ball = {s * view.ball_position.x, s * view.ball_position.y, view.ball_position.z};
  seen.velocity = {s * view.ball_velocity.x, s * view.ball_velocity.y, view.ball_velocity.z};
  seen.spin = {s * view.ball_spin.x, s * view.ball_spin.y, view.ball_spin.z};
  for (int rod = 0; rod < kRods; ++rod) {
    seen.slide[rod] = team_slide(team_, view.rods[rod].slide);
    seen.swing[rod] = team_swing(team_, view.rods[rod].angle);
    seen.slide_rate[rod] = team_slide(team_, view.rods[rod].slide_rate);
    seen.swing_rate[rod] = team_swing(team_, view.rods[rod].angle_rate);
  }
  return seen;
}

double y_after(const TableSpec& table, double y, double vy, double time) {
  const double wall = 0.5 * table.width - table.ball_radius;
  // Unfold the reflections: the path repeats after twice the width between the walls.
  const double span = 2.0 * wall;
  double along = std::fmod(y + vy * time + wall, 2.0 * span);
  if (along < 0.0) along += 2.0 * span;
  return (along <= span ? along : 2.0 * span - along) - wall;
}

}  // namespace foosball
