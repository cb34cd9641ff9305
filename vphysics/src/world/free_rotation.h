// Torque-free rotation of a rigid body: Euler's equations over any time.
//
// With L = I w in the body frame, a part s of the time takes the implicit midpoint
//   m = w + (a / 2) I^-1 (I m x m),  a = 2 tan(s |w| / 2) / |w|,
// and rotates the body by Cayley's map of (a / 2) m. This conserves L exactly: I w and I w' are the
// same vector in the world frame. Quadratic invariants are conserved for any a, so the energy is
// conserved to the accuracy of Newton's method, 1e-12, for every step length. This a makes rotation
// about a principal axis exact. The parts are short enough for Newton's method and for the
// nutation.
//
// Source: Hairer, Lubich, Wanner, Geometric Numerical Integration, IV.2.1 and VII.5.
#pragma once

#include "vphysics/lie.h"

namespace vp {

struct FreeRotation {
  Quaternion q;         // rotation from the frame at the end to that at the start
  Vec3 w;               // at the end, in the frame at the end [rad/s]
  Vec3 rotation_sum{};  // sum of the parts' rotations, each in its own frame [rad]
};

// Below this rotation [rad] in a step w is taken as constant: energy is conserved to its square.
inline constexpr double kHardlyRotates = 1e-6;
inline bool hardly_rotates(const Vec3& w, double dt) {
  return dt * dt * dot(w, w) < kHardlyRotates * kHardlyRotates;
}

// I: about the centre of mass. I and w in the body frame.
FreeRotation free_rotation(const Sym3& I, const Sym3& inverse, const Vec3& w, double dt);

// The rotation at a constant angular velocity that ends at the same orientation [rad], in the frame
// at the start.
Vec3 mean_rotation(const FreeRotation& rotation);

}  // namespace vp
