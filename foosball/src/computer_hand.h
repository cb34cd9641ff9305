// The hand of a computer player on one rod: moves with a hand's speeds and accelerations, so that
// it can do nothing a person could not. In its team's frame: see computer_sight.h.
#pragma once

namespace foosball {

struct AxisLimits {
  double rate;          // most speed [m/s or rad/s]
  double acceleration;  // [m/s^2 or rad/s^2]
};

// One coordinate on its way to where it is wanted, with a bounded rate and acceleration.
class HandAxis {
 public:
  double position() const { return position_; }
  double rate() const { return rate_; }
  void adopt(double position) {
    position_ = position;
    rate_ = 0.0;
  }
  // One kTick. Brakes in time to stop at the goal.
  void move(double goal, const AxisLimits& limits);
  // One kTick towards the goal and through it: no braking before it is reached.
  void swing(double goal, const AxisLimits& limits);
  // One kTick of slowing down to rest.
  void brake(const AxisLimits& limits) { accelerate(0.0, limits); }

 private:
  void accelerate(double wanted_rate, const AxisLimits& limits);
  double position_ = 0.0, rate_ = 0.0;
};

}  // namespace foosball
