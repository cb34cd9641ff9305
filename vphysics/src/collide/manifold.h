// Contact manifolds: where two shapes touch or nearly touch.
#pragma once

#include <cstdint>

#include "collide/pair_cache.h"
#include "collide/pair_margin.h"

namespace vp::collide {

inline constexpr int kMaxPoints = 4;

struct ManifoldPoint {
  Vec3 position;          // world frame, midway between the two surfaces
  double separation;      // along the normal; negative: penetration
  std::uint32_t feature;  // persistent from step to step while the same features touch
};

struct Manifold {
  Vec3 normal;  // unit, world frame, from a to b
  int count = 0;
  bool rough = false;  // its depth is less accurate than required: CorePair::rough
  // Without points: the normal separates them by so much, a lower bound of their distance [m]. The
  // normal is zero if no such direction is known.
  double min_separation = 0.0;
  ManifoldPoint points[kMaxPoints];

  void add(const Vec3& position, double separation, std::uint32_t feature) {
    if (count < kMaxPoints) points[count++] = {position, separation, feature};
  }
};

// Finds the contact points of two shapes that may touch within the margin. Precondition: not two
// half-spaces.
//
// The normal is the direction of minimum penetration, or of minimum distance if they are separated.
// If a face does nearly as well (within 5% and 1e-5 of the smaller shape's size), its normal and
// the patch over it are used: face manifolds have several points and are stable.
void find_manifold(const Geometry& a, const SE3& T_a, const Geometry& b, const SE3& T_b,
                   const PairMargin& margin, PairCache& cache, Manifold& manifold);
// Without a cache, for a single query.
void find_manifold(const Geometry& a, const SE3& T_a, const Geometry& b, const SE3& T_b,
                   const PairMargin& margin, Manifold& manifold);

}  // namespace vp::collide
