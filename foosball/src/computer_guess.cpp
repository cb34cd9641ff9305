#include "computer_guess.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace foosball {
namespace {

constexpr double kStep = 0.002;       // [s]
constexpr double kFoot = 0.073;       // axis to sole [m]
constexpr double kHalfDepth = 0.010;  // of a foot [m]
constexpr double kFeetUp = 0.8;  // |swing| beyond which a rolling ball passes below the foot [rad]
constexpr double kManBounce = 0.6;  // restitution of a man

class Flight {
 public:
  Flight(const GuessModel& model, const Tuning& tuning, const Sighting& rods, BallGuess& ball)
      : m_(model), tuning_(tuning), p_(ball.position), v_(ball.velocity) {
    find_rows(rods);
  }

  // Returns false if the ball's state is unchanged: then no further step changes it.
  bool step() {
    before_ = p_;
    const vp::Vec3 velocity = v_;
    p_ = p_ + kStep * v_;
    v_.z -= field_.fall;
    if (p_.z <= field_.radius) field_.bounce(p_.z, v_.z);
    bounce_off_walls();
    bounce_off_men();
    return !(p_ == before_ && v_ == velocity);
  }

  // Takes as many steps at once as are certain to be free of collisions, at most `most`. Returns
  // their number. step() handles the collision that may follow.
  int skip(int max) {
    const Cell cell = free_cell();
    const double dx = kStep * v_.x, dy = kStep * v_.y;
    const bool rolls = field_.rolls(p_.z, v_.z);
    double free = max;
    free = std::min(free, steps_within(cell.x, p_.x, dx));
    free = std::min(free, steps_within(cell.y, p_.y, dy));
    if (!rolls) free = std::min(free, field_.steps_above(p_.z, v_.z));
    const int steps = static_cast<int>(free);
    if (steps <= 0) return 0;
    const double n = steps;
    p_.x += n * dx;
    p_.y += n * dy;
    if (rolls) return steps;
    p_.z += kStep * (n * v_.z - field_.fall * (0.5 * n * (n - 1.0)));
    v_.z -= n * field_.fall;
    return steps;
  }

 private:
  struct Field {
    double radius, fall, hop_from, restitution;  // fall: velocity change by gravity in a step [m/s]

    void bounce(double& z, double& rise) const {
      z = radius;
      rise = rise < -hop_from ? -restitution * rise : 0.0;
    }
    // True if a step leaves height and vertical velocity unchanged.
    bool rolls(double z, double rise) const {
      return z == radius && rise == 0.0 && fall <= hop_from;
    }
    // Steps of free fall until landing, minus one: after n steps the height is z + h (n rise - fall
    // n (n - 1) / 2). Negative without gravity: such a ball is stepped one by one.
    double steps_above(double z, double rise) const {
      if (!(fall > 0.0)) return -1.0;
      const double a = 0.5 * fall, b = rise + a;
      return (b + std::sqrt(std::max(0.0, b * b + 4.0 * a * (z - radius) / kStep))) / fall - 1.0;
    }
  };

  // Lower bound on the number of steps with displacement `step` before the position leaves the
  // range, minus one. Negative outside the range.
  static double steps_within(const double (&range)[2], double at, double step) {
    if (!(at > range[0] && at < range[1])) return -1.0;
    constexpr double kEver = 1e9;
    if (step > 0.0) return std::min(kEver, (range[1] - at) / step) - 1.0;
    return step < 0.0 ? std::min(kEver, (range[0] - at) / step) - 1.0 : kEver;
  }

  // Own men who hang down, by row.
  struct Row {
    const RodSpec* spec;
    double x;  // of their feet, in the team's frame [m]
    double slide;
  };

  // A region in which the ball's centre touches no wall and no man.
  struct Cell {
    double x[2], y[2];
  };

  // The free cell around the ball; empty if the ball touches something now. A margin covers
  // rounding of its bounds.
  Cell free_cell() const {
    constexpr double kRounding = 1e-9;  // [m]
    const double end = 0.5 * m_.table->length - radius(), side = 0.5 * m_.table->width - radius();
    Cell cell{{-end, end}, {-side, side}};
    const auto keep_out = [](double(&free)[2], double at, double from, double reach) {
      if (at <= from) free[1] = std::min(free[1], from - reach - kRounding);
      if (at >= from) free[0] = std::max(free[0], from + reach + kRounding);
    };
    for (std::size_t i = 0; i < rows_; ++i) {
      const Row& row = own_[i];
      if (std::fabs(p_.x - row.x) > reach_) {
        keep_out(cell.x, p_.x, row.x, reach_);
        continue;
      }
      for (int man = 0; man < row.spec->men; ++man) {
        keep_out(cell.y, p_.y, man_offset(*row.spec, man) + row.slide, beside_);
      }
    }
    return cell;
  }

  // Only own men: the opponent's have moved since they were seen.
  void find_rows(const Sighting& rods) {
    for (std::size_t rod = 0; rod < kRods; ++rod) {
      const RodSpec& spec = m_.table->rods[rod];
      if (spec.team != m_.team) continue;
      const double swing = within_half_turn(rods.swing[rod]);  // towards +x
      if (std::fabs(swing) > kFeetUp) continue;
      own_[rows_++] = {&spec, attack_sign(m_.team) * spec.x + kFoot * swing, rods.slide[rod]};
    }
  }

  double radius() const { return m_.table->ball_radius; }

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
    for (std::size_t i = 0; i < rows_; ++i) {
      const Row& row = own_[i];
      if (std::fabs(p_.x - row.x) > reach_) continue;
      for (int man = 0; man < row.spec->men; ++man) {
        const double y = man_offset(*row.spec, man) + row.slide;
        if (std::fabs(p_.y - y) < beside_) return bounce_off_man(row.x, reach_);
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
  vp::Vec3 &p_, &v_;
  vp::Vec3 before_;
  const Field field_{radius(), kStep* tuning_.gravity, tuning_.hop_from, tuning_.field_restitution};
  std::array<Row, kRods> own_;
  std::size_t rows_ = 0;
  const double reach_ = kHalfDepth + radius();
  const double beside_ = m_.half_foot[static_cast<std::size_t>(m_.team)] + 0.9 * radius();
};

}  // namespace

BallGuess advance(const GuessModel& model, const Tuning& tuning, const Sighting& rods,
                  const BallGuess& from, double time) {
  BallGuess ball = from;
  Flight flight(model, tuning, rods, ball);
  const int steps = static_cast<int>(std::lround(time / kStep));
  for (int left = steps; left > 0 && flight.step();) {
    --left;
    left -= flight.skip(left);
  }
  return ball;
}

}  // namespace foosball
