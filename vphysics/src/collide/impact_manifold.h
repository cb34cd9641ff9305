// The manifold of two bodies that will collide within the step, where they will collide.
//
// The solver moves the bodies along straight lines, with the normal and the arms of each contact
// fixed for the step. Taken at the start of a step, the normal between a ball and the edge that it
// is about to roll over leans against the motion, and a box that slides from one tile to the next
// faces the side of that tile: both would be stopped by a plane that is not there ("ghost
// collision"). So the manifold of a pair that closes within the step is found at the poses of the
// impact, and its separations are extrapolated back to the start.
#pragma once

#include "collide/manifold.h"
#include "collide/sweep.h"

namespace vp::collide {

// How far the points `x` of the two motions move until the impact [m].
struct MotionToImpact {
  Vec3 a, b;
};

// If the two collide within dt and the normal at the impact differs from the normal now: replaces
// the manifold by that at the impact, and adds to its separations what the motion closes until
// then. Else leaves it as it is, and returns 0. The impact is where the surfaces overlap by the
// tolerance, so that an overlap of less at the side, as of a box that rests on its ground, decides
// the normal. Precondition: two convex shapes; the manifold is theirs at the present poses, within
// the margin.
MotionToImpact move_to_impact(const Geometry& a, const SE3& T_a, const Geometry& b, const SE3& T_b,
                              const PairMotion& motion, double margin, Manifold& manifold);

}  // namespace vp::collide
