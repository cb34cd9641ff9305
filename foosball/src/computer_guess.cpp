#include "computer_guess.h"

#include <algorithm>
#include <cmath>

namespace foosball {
namespace {

constexpr double kStep = 0.002;       // [s]
constexpr double kFoot = 0.073;       // axis to sole [m]
constexpr double kHalfDepth = 0.010;  // of a foot [m]
constexpr double kFeetUp = 0.8;       // |swing| from which a rolling ball passes below [rad]
constexpr double kManBounce = 0.6;    // of the ball's speed towards a man

class Flight {
 public:
  Flight(const GuessModel& model, const Tuning& tuning, const Sighting& rods, BallGuess& ball)
      : m_(model), tuning_(tuning), rods_(rods), p_(ball.position), v_(ball.velocity) {}

  void step() {
    before_ = p_;
    p_ = p_ + kStep * v_;
    bounce_off_field();
    bounce_off_walls();
    bounce_off_men();
  }

 private:
  double radius() const { return m_.table->ball_radius; }

  void bounce_off_field() {
    v_.z -= kStep * tuning_.gravity;
    if (p_.z > radius()) return;
    p_.z = radius();
    v_.z = v_.z < -tuning_.hop_from ? -tuning_.field_restitution * v_.z : 0.0;
  }

  void bounce_off_walls() {
    const double side = 0.5 * m_.table->width - radius();
    if (std::fabs(p_.y) > side) {
      p_.y = std::copysign(side, p_.y);
      if (p_.y * v_.y > 0.0) v_.y *= -tuning_.wall_restitution;
    }
    const double end = 0.5 * m_.table->length - radius();
    if (std::fabs(p_.x) > end && std::fabs(p_.y) > 0.5 * m_.table->goal_width) {
      p_.x = std::copysign(end, p_.x);
      if (p_.x * v_.x > 0.0) v_.x *= -tuning_.wall_restitution;
    }
  }

  void bounce_off_men() {
    constexpr double kHigh = 0.10;
    if (p_.z > kHigh) return;
    for (std::size_t rod = 0; rod < kRods; ++rod) {
      const RodSpec& spec = m_.table->rods[rod];
      if (spec.team != m_.team) continue;  // where the others' men were, they are no more
      const double swing = std::remainder(rods_.swing[rod], 2.0 * vp::kPi);
      if (std::fabs(swing) > kFeetUp) continue;
      const double lean = spec.team == m_.team ? swing : -swing;  // towards +x
      const double x = attack_sign(m_.team) * spec.x + kFoot * lean;
      const double reach = kHalfDepth + radius();
      if (std::fabs(p_.x - x) > reach) continue;
      for (int man = 0; man < spec.men; ++man) {
        const double y = man_offset(spec, man) + rods_.slide[rod];
        const double beside = m_.half_foot[static_cast<std::size_t>(spec.team)] + 0.9 * radius();
        if (std::fabs(p_.y - y) < beside) return bounce_off_man(x, reach);
      }
    }
  }

  void bounce_off_man(double x, double reach) {
    const double side = before_.x < x ? -1.0 : 1.0;
    const bool from_front = std::fabs(before_.x - x) > reach - 0.004;
    if (from_front) {
      p_.x = x + side * reach;
      if (side * v_.x < 0.0) v_.x *= -kManBounce;
    } else {
      p_.y = before_.y;
      v_.y *= -kManBounce;
    }
  }

  const GuessModel& m_;
  const Tuning& tuning_;
  const Sighting& rods_;
  vp::Vec3 &p_, &v_;
  vp::Vec3 before_;
};

}  // namespace

BallGuess advance(const GuessModel& model, const Tuning& tuning, const Sighting& rods,
                  const BallGuess& from, double time) {
  BallGuess ball = from;
  Flight flight(model, tuning, rods, ball);
  const int steps = static_cast<int>(std::lround(time / kStep));
  for (int i = 0; i < steps; ++i) flight.step();
  return ball;
}

}  // namespace foosball
