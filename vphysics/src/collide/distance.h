// How far apart two shapes are, or how deep in one another.
#pragma once

#include "collide/geometry.h"
#include "collide/pair_cache.h"

namespace vp::collide {

struct ClosestPoints {
  // Negative: the least distance that one has to be moved until they only touch.
  double distance;
  Vec3 normal;      // unit, world frame: from a to b where they are apart, b's way out where not
  Vec3 on_a, on_b;  // world frame; on_b - on_a = distance normal
};

// Precondition: not two half-spaces.
ClosestPoints closest_points(const Geometry& a, const SE3& T_a, const Geometry& b, const SE3& T_b,
                             PairCache& cache);

// The same question without the answer's details: cheaper. Touching counts.
bool shapes_overlap(const Geometry& a, const SE3& T_a, const Geometry& b, const SE3& T_b,
                    PairCache& cache);

}  // namespace vp::collide
