// How a body turns that nothing touches: Euler's equations over any time.
//
// With L = I w in the body's frame, a part s of the time takes the implicit midpoint
//   m = w + (a / 2) I^-1 (I m x m),  a = 2 tan(s |w| / 2) / |w|,
// and turns the body by Cayley's map of (a / 2) m, which carries L along exactly: I w and I w' are
// the same vector of the world. Quadratic invariants are kept whatever a is, so the energy is kept
// to the accuracy of Newton's method, 1e-12, at every length of the step; this a makes a turn about
// a principal axis exact. Parts are short enough for Newton's method and for the nutation.
//
// Source: Hairer, Lubich, Wanner, Geometric Numerical Integration, IV.2.1 and VII.5.
#pragma once

#include "vphysics/lie.h"

namespace vp {

struct FreeRotation {
  Quaternion q;         // from the frame at the end to that at the start
  Vec3 w;               // at the end, in the frame of the end [rad/s]
  Vec3 rotation_sum{};  // the sum of the parts' turns, each in its own frame [rad]
};

// Below this turn [rad] in a step the rate is taken as constant: energy is kept to its square.
inline constexpr double kHardlyRotates = 1e-6;
inline bool hardly_rotates(const Vec3& w, double dt) {
  return dt * dt * dot(w, w) < kHardlyRotates * kHardlyRotates;
}

// Inertia I about the centre of mass and w in the body's frame.
FreeRotation free_rotation(const Sym3& I, const Sym3& inverse, const Vec3& w, double dt);

// The one turn at a constant rate that comes to the same end [rad], in the start's frame.
Vec3 mean_rotation(const FreeRotation& rotation);

}  // namespace vp
