// Distance or penetration depth of two shapes.
#pragma once

#include "collide/geometry.h"
#include "collide/pair_cache.h"

namespace vp::collide {

struct ClosestPoints {
  // Negative: the penetration depth, the minimum translation that separates them.
  double distance;
  Vec3 normal;      // unit, world frame: from a to b; in penetration, b's exit direction
  Vec3 on_a, on_b;  // world frame; on_b - on_a = distance normal
};

// Precondition: not two half-spaces.
ClosestPoints closest_points(const Geometry& a, const SE3& T_a, const Geometry& b, const SE3& T_b,
                             PairCache& cache);

// Only whether they overlap: cheaper. Touching counts as overlap.
bool shapes_overlap(const Geometry& a, const SE3& T_a, const Geometry& b, const SE3& T_b,
                    PairCache& cache);

}  // namespace vp::collide
