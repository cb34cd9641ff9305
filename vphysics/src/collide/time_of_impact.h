// When do two moving shapes meet? Of any two convex ones, however fast they go and turn.
#pragma once

#include "collide/gjk.h"
#include "collide/pair_cache.h"
#include "collide/sweep.h"

namespace vp::collide {

struct MovingShape {
  const Geometry* shape;
  SE3 T;          // at time 0
  Motion motion;  // of the body that carries it
};
SE3 pose_at(const MovingShape& moving, double time);

struct ImpactQuery {
  MovingShape a, b;
  double duration;   // [s]
  double tolerance;  // how near to the target counts as reached [m]; above rounding
};

// The first time at which the separation has come down to target [m], or a negative number if it
// does not within the duration. Never later than the true time; earlier by what the tolerance
// allows, and where the two pass so near to one another that kMaxAdvances do not lead past.
// Precondition: convex shapes or triangles, of which one may be a half-space instead.
//
// latest: what comes later is not looked for. Unlike a shorter duration it changes no bit of what
// comes before.
double time_of_impact(const ImpactQuery& query, double target, PairCache& cache, double latest);
inline double time_of_impact(const ImpactQuery& query, double target, PairCache& cache) {
  return time_of_impact(query, target, cache, query.duration);
}

}  // namespace vp::collide
