#include "spin_watch.h"

#include <cmath>

#include "vphysics/lie.h"

namespace foosball {
namespace {

constexpr double kRevolution = 2.0 * vp::kPi;
// A rod that rotates back by less keeps its direction of rotation [rad].
constexpr double kBack = 0.3;

}  // namespace

void SpinWatch::reset(double angle) {
  *this = {};
  from_ = furthest_ = angle;
}

void SpinWatch::update(double angle, bool touches) {
  const double moved = furthest_ != from_ ? furthest_ - from_ : angle - furthest_;
  const double direction = moved >= 0.0 ? 1.0 : -1.0;
  const double ahead = direction * (angle - furthest_);
  if (ahead > 1e-4) {
    furthest_ = angle;
    still_ticks_ = 0;
  } else {
    count_tick(still_ticks_);
  }
  // The direction reversed, or the rod stopped: a new rotation begins.
  if (ahead < -kBack || still_ticks_ >= kStopTicks) {
    from_ = ahead < -kBack ? furthest_ : angle;
    furthest_ = angle;
    if (!touches) struck_ = false;
  }
  if (touches) {
    struck_ = true;
    struck_at_ = angle;
    spun_ = std::fabs(angle - from_) > kRevolution;
  } else if (struck_ && std::fabs(angle - struck_at_) > kRevolution) {
    spun_ = true;
  }
}

}  // namespace foosball
