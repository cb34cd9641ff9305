// The force law of a joint: the relation of the impulse p of its springs, dampers, friction, limits
// and motor in a step to the velocity w at the end of the step. Each is a clamped ramp:
//
//   p = min(highest, max(lowest, slope (w0 - w)))
//
// A ramp of infinite slope is a step at w0, where p may have any value in between: dry friction (w0
// = 0), or a stop (w0 is the velocity that just reaches it). The sum of the ramps does not increase
// with w, so it intersects any line w = z + D p, D > 0, exactly once: the solution is unique for
// any response of the rest of the tree.
#pragma once

#include <array>
#include <cstddef>
#include <limits>

namespace vp::detail {

inline constexpr double kUnbounded = std::numeric_limits<double>::infinity();

struct Ramp {
  double slope, w0;
  double lowest = -kUnbounded, highest = kUnbounded;

  double at(double w) const;  // w != w0 if the slope is infinite
};

// A point on the force law: at a step, with a given velocity, or on the line p = alpha - beta w.
struct ForceLawPoint {
  double w, p;
  bool at_step;
  double alpha, beta;
};

class ForceLaw {
 public:
  void clear() { count_ = 0; }
  // At most kMax. A ramp steeper than the rounding of velocities allows counts as a step.
  void add(Ramp ramp);
  // The intersection with w = z + D p; D > 0.
  ForceLawPoint intersect(double z, double D) const;
  // velocity_for: the velocity at which the law has p; clamped_impulse: p clamped to the law's
  // range.
  double velocity_for(double p) const;
  double clamped_impulse(double p) const;
  // The part of p from the first ramp at w. Where friction or a stop could supply the same impulse,
  // the impulse of the ramp alone.
  double part_of_first(double w, double p) const;

 private:
  static constexpr std::size_t kMax = 5;  // motor, spring and damper, friction, two limits

  struct Corners {
    std::array<double, 2 * kMax> w;
    std::size_t count;
    double inside(std::size_t i) const;  // an inner velocity of the piece before corner i
  };
  struct Line {
    double alpha, beta;
  };
  Corners corners() const;
  double sum(double w, bool from_left) const;
  Line line_at(double inside) const;
  ForceLawPoint on_line(const Line& line, double z, double D) const;

  std::array<Ramp, kMax> ramps_{};
  std::size_t count_ = 0;
};

}  // namespace vp::detail
