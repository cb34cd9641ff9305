// The hand of a computer player on one rod. It moves with the speeds and accelerations of a human
// hand, so that it cannot do more than a person. In the team's frame: see computer_sight.h.
#pragma once

namespace foosball {

struct AxisLimits {
  double rate;          // maximum speed [m/s or rad/s]
  double acceleration;  // [m/s^2 or rad/s^2]
};

// One coordinate that moves to its goal with bounded rate and acceleration.
class HandAxis {
 public:
  double position() const { return position_; }
  double rate() const { return rate_; }
  void adopt(double position) {
    position_ = position;
    rate_ = 0.0;
  }
  // One kTick. Brakes early enough to stop at the goal.
  void move(double goal, const AxisLimits& limits);
  // One kTick towards the goal and through it, without braking before it.
  void swing(double goal, const AxisLimits& limits);
  // One kTick of braking to rest.
  void brake(const AxisLimits& limits) { accelerate(0.0, limits); }

 private:
  void accelerate(double target_rate, const AxisLimits& limits);
  double position_ = 0.0, rate_ = 0.0;
};

}  // namespace foosball
