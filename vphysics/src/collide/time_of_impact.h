// Time of impact of two moving convex shapes, at any linear and angular velocity.
#pragma once

#include "collide/gjk.h"
#include "collide/pair_cache.h"
#include "collide/sweep.h"

namespace vp::collide {

struct MovingShape {
  const Geometry* shape;
  SE3 T;          // at time 0
  Motion motion;  // of the shape's body
};
SE3 pose_at(const MovingShape& moving, double time);

struct ImpactQuery {
  MovingShape a, b;
  double duration;  // [s]
  // Separations up to target + tolerance count as reached [m]; above rounding error.
  double tolerance;
};

// The first time at which the separation has decreased to target [m], or a negative number if there
// is none within the duration. Never later than the true time. Earlier within the tolerance, and
// also where the two pass so close to each other that kMaxAdvances steps do not lead past.
// Precondition: convex shapes or triangles; one may be a half-space instead.
//
// latest: the search ends there. Unlike a shorter duration it changes no bit of an earlier result.
double time_of_impact(const ImpactQuery& query, double target, PairCache& cache, double latest);
inline double time_of_impact(const ImpactQuery& query, double target, PairCache& cache) {
  return time_of_impact(query, target, cache, query.duration);
}

}  // namespace vp::collide
