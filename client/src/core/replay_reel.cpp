#include "core/replay_reel.h"

#include <algorithm>
#include <iterator>

#include "client/interpolator.h"
#include "core/match_story.h"
#include "wire/enums.h"

namespace client {

bool ReplayReel::follow(wire::Snapshot& drawn, std::int64_t now_us) {
  constexpr std::uint8_t kPlay = wire::number(wire::Screen::play);
  const bool goal = stopped_for_goal(drawn);
  if (goal && screen_before_ == kPlay) mark_goal(now_us);
  if (drawn.screen == kPlay && screen_before_ != kPlay) clear();
  screen_before_ = drawn.screen;
  if (!goal || !showing(now_us)) {
    if (!drawn.paused) record(drawn, now_us);
    return false;
  }
  const wire::Snapshot again = scene(now_us);
  drawn.ball = again.ball;
  drawn.ball_in_play = true;
  drawn.rods = again.rods;
  drawn.men = again.men;
  return true;
}

void ReplayReel::record(const wire::Snapshot& scene, std::int64_t now_us) {
  if (!frames_.empty() && now_us <= frames_.back().at_us) return;
  frames_.push_back({now_us, scene});
  while (now_us - frames_.front().at_us > kKeptUs) frames_.pop_front();
}

void ReplayReel::mark_goal(std::int64_t now_us) {
  goal_us_ = now_us;
  goal_ = true;
  skipped_ = false;
}

void ReplayReel::clear() {
  frames_.clear();
  goal_ = skipped_ = false;
}

// In the time of the replayed play.
std::int64_t ReplayReel::shown_us(std::int64_t now_us) const {
  const std::int64_t since = now_us - goal_us_ - kWaitUs;
  return goal_us_ - kBeforeUs + static_cast<std::int64_t>(kSpeed * static_cast<double>(since));
}

bool ReplayReel::showing(std::int64_t now_us) const {
  if (!goal_ || skipped_ || frames_.size() < 2 || now_us < goal_us_ + kWaitUs) return false;
  return shown_us(now_us) < std::min(goal_us_ + kAfterUs, frames_.back().at_us);
}

wire::Snapshot ReplayReel::scene(std::int64_t now_us) const {
  const std::int64_t at = shown_us(now_us);
  if (at <= frames_.front().at_us) return frames_.front().scene;
  const auto after = std::find_if(frames_.begin(), frames_.end(),
                                  [&](const Frame& frame) { return frame.at_us > at; });
  if (after == frames_.end()) return frames_.back().scene;
  const auto before = std::prev(after);
  const auto span = static_cast<double>(after->at_us - before->at_us);
  return interpolate(before->scene, after->scene, static_cast<double>(at - before->at_us) / span,
                     1e-6 * span);
}

}  // namespace client
