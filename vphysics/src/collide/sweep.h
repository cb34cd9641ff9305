// Time of impact of a moving sphere and a moving shape.
#pragma once

#include "collide/geometry.h"

namespace vp::collide {

// A rigid motion with constant velocities in the world: the point x moves at v, the body rotates
// about it at w.
struct Motion {
  Vec3 x, v, w;  // world frame [m, m/s, rad/s]

  Vec3 velocity(const Vec3& at) const { return v + cross(w, at - x); }
};

struct PairMotion {
  Motion a, b;
  double dt;  // [s]
  // An overlap [m] that counts as none: within it, the impact may be at another face.
  double tolerance;
};

struct SweepQuery {
  Vec3 centre;  // of the sphere at time 0, world frame
  double radius;
  Motion sphere;  // of the sphere's body
  const Geometry* shape;
  SE3 T_shape;   // at time 0
  Motion other;  // of the shape's body
  double duration;
  double tolerance;  // separations up to target + tolerance count as reached [m]
};

// The separation of sphere and shape at `time` [s] from now. Precondition: the shape is convex.
double separation_at(const SweepQuery& query, double time);

// The first time at which the separation has decreased to target, or a negative number if there is
// none within the duration. Never later than the true time; earlier within the tolerance.
// Precondition: the separation at time 0 exceeds target.
//
// For a compound it is the separation from its parts. For a surface, it is the distance to the
// active parts of each triangle (triangle_contact.h), if the sphere's centre is in front of it at
// time 0: where find_manifolds has no contact there is no impact.
double time_of_impact(const SweepQuery& query, double target);

}  // namespace vp::collide
