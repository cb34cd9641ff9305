#include "player.h"

#include <algorithm>
#include <cmath>
#include <optional>

#define N_(english) english  // for xgettext: render/translate.h

namespace watch {

bool Player::act(Command command) {
  const double total = static_cast<double>(timeline_->findings().total);
  switch (command) {
    case Command::play:
      if (paused_ && tick_ >= total) go_to(0.0);  // from the beginning again
      paused_ = !paused_;
      return true;
    case Command::slower:
      speed_ = std::max(speed_ - 1, 0);
      return true;
    case Command::faster:
      speed_ = std::min(speed_ + 1, static_cast<int>(kSpeeds.size()) - 1);
      return true;
    case Command::tick_back:
      step(-1.0);
      return true;
    case Command::tick_on:
      step(1.0);
      return true;
    case Command::back:
      go_to(tick_ - 1'000.0);
      return true;
    case Command::on:
      go_to(tick_ + 1'000.0);
      return true;
    case Command::far_back:
      go_to(tick_ - 10'000.0);
      return true;
    case Command::far_on:
      go_to(tick_ + 10'000.0);
      return true;
    case Command::previous_goal:
      go_to_goal(-1);
      return true;
    case Command::next_goal:
      go_to_goal(1);
      return true;
    case Command::begin:
      go_to(0.0);
      return true;
    case Command::end:
      go_to(total);
      return true;
    default:
      return false;
  }
}

// Steps by single ticks; pauses the playback.
void Player::step(double ticks) {
  paused_ = true;
  go_to(std::floor(tick_) + ticks);
}

void Player::drag(double seconds) {
  dragging_ = true;
  const double tick = std::round(1e3 * seconds);
  if (std::abs(tick - tick_) >= 1.0) go_to(tick);
}

void Player::go_to(double tick) {
  tick = std::max(0.0, tick);
  if (!timeline_->seek(static_cast<std::uint64_t>(tick))) {
    message_ = N_("this moment cannot be restored: the file was written by another release");
    return;
  }
  tick_ = static_cast<double>(timeline_->scene().ticks());
  jumped_ = true;
}

// Goals closer than kNear are skipped, so that a jump back right after another one moves on.
void Player::go_to_goal(int direction) {
  constexpr double kNear = 500.0;  // ticks
  const Findings findings = timeline_->findings();
  std::optional<double> found;
  for (const Goal& goal : findings.goals) {
    const double at = std::max(0.0, static_cast<double>(goal.tick) - kBeforeGoal);
    if (direction > 0 && at > tick_ + kNear) {
      found = at;
      break;
    }
    if (direction < 0 && at < tick_ - kNear) found = at;
  }
  if (found) return go_to(*found);
  if (!findings.done && direction > 0) {
    message_ = N_("still reading the recording: try again");
  } else {
    message_ = findings.goals.empty() ? N_("no goal was scored") : N_("no goal in that direction");
  }
}

void Player::advance(double dt) {
  if (stands()) return;
  const Findings findings = timeline_->findings();
  const auto total = static_cast<double>(findings.total);
  tick_ = std::min(tick_ + 1e3 * speed() * dt, total);
  timeline_->play_to(static_cast<std::uint64_t>(tick_));
  // At the end the playback pauses. In a recording that is still written it waits for more.
  if (tick_ >= total && findings.done && !findings.being_made) paused_ = true;
}

}  // namespace watch
