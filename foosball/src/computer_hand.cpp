#include "computer_hand.h"

#include <algorithm>
#include <cmath>

#include "foosball/table.h"

namespace foosball {

void HandAxis::move(double goal, const AxisLimits& limits) {
  const double error = goal - position_;
  // v^2 = 2 a d with 90 % of the acceleration, as a margin. Within one tick of the goal it moves
  // there.
  const double stopping = std::sqrt(1.8 * limits.acceleration * std::fabs(error));
  const double speed = std::min({limits.rate, stopping, std::fabs(error) / kTick});
  accelerate(std::copysign(speed, error), limits);
}

void HandAxis::swing(double goal, const AxisLimits& limits) {
  accelerate(std::copysign(limits.rate, goal - position_), limits);
}

void HandAxis::accelerate(double target_rate, const AxisLimits& limits) {
  const double max = limits.acceleration * kTick;
  rate_ += std::clamp(target_rate - rate_, -max, max);
  position_ += rate_ * kTick;
}

}  // namespace foosball
