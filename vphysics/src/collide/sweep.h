// When does a moving sphere meet a moving shape?
#pragma once

#include "collide/geometry.h"

namespace vp::collide {

// A rigid motion of constant twist in the world: the point x moves at v, all else turns about it at
// w.
struct Motion {
  Vec3 x, v, w;  // world frame [m, m/s, rad/s]
};

struct SweepQuery {
  Vec3 centre;  // of the sphere at time 0, world frame
  double radius;
  Motion sphere;  // of the body that carries the sphere
  const Geometry* shape;
  SE3 T_shape;   // at time 0
  Motion other;  // of the body that carries the shape
  double duration;
  double tolerance;  // how near to the target counts as reached [m]
};

// Separation of sphere and shape, time seconds from now. Precondition: the shape is convex.
double separation_at(const SweepQuery& query, double time);

// The first time at which the separation has come down to target, or a negative number if it does
// not within the duration. Never later than the true time; earlier by what the tolerance allows.
// Precondition: the separation at time 0 exceeds target.
//
// Of a compound that is the separation from its parts. Of a surface, from what of each triangle can
// be felt (triangle_contact.h), if the sphere's centre is before it at time 0: where find_manifolds
// has no contact there is no impact.
double time_of_impact(const SweepQuery& query, double target);

}  // namespace vp::collide
