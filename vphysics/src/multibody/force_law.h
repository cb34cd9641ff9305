// What a joint's springs, dampers, friction, limits and motor can do within a step, as a relation
// of the impulse p to the velocity w at the step's end. Each is a ramp, cut off at what it can do:
//
//   p = min(highest, max(lowest, slope (w0 - w)))
//
// Of infinite slope it is a step at w0, where p may be anything between: dry friction (w0 = 0), a
// stop (w0 is the velocity that just reaches it). Their sum never rises with w, so that it meets
// any line w = z + D p, D > 0, exactly once: there is one answer to whatever the rest of the tree
// does.
#pragma once

#include <array>
#include <cstddef>
#include <limits>

namespace vp::detail {

inline constexpr double kUnbounded = std::numeric_limits<double>::infinity();

struct Ramp {
  double slope, w0;
  double lowest = -kUnbounded, highest = kUnbounded;

  double at(double w) const;  // w != w0 where the slope is infinite
};

// Where the law is on the line: at a velocity (of a step), or on p = alpha - beta w.
struct ForceLawPoint {
  double w, p;
  bool at_step;
  double alpha, beta;
};

class ForceLaw {
 public:
  void clear() { count_ = 0; }
  // At most kMax. A ramp steeper than its velocities' rounding counts as a step.
  void add(Ramp ramp);
  // The point with w = z + D p; D > 0.
  ForceLawPoint intersect(double z, double D) const;
  // The velocity at which the law has p; p cut off at what the law can do at all.
  double velocity_for(double p) const;
  double cut_off(double p) const;
  // What the first ramp does of p at w; where friction or a stop could do the same, what it would
  // by itself.
  double fraction_of_first(double w, double p) const;

 private:
  static constexpr std::size_t kMax = 5;  // motor, spring and damper, friction, two limits

  struct Corners {
    std::array<double, 2 * kMax> w;
    std::size_t count;
    double inside(std::size_t i) const;  // of the piece before corner i
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
