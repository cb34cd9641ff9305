// Where two shapes touch or nearly touch.
#pragma once

#include <cstdint>

#include "collide/geometry.h"
#include "collide/pair_cache.h"

namespace vp::collide {

inline constexpr int kMaxPoints = 4;

struct ManifoldPoint {
  Vec3 position;          // world frame, midway between the two surfaces
  double separation;      // along the normal; negative: penetration
  std::uint32_t feature;  // the same from step to step while the same features touch
};

struct Manifold {
  Vec3 normal;  // unit, world frame, from a to b
  int count = 0;
  bool rough = false;  // its depth is less certain than it should be: CorePair::rough
  // Without points: no more than the distance of the two, as far as it has come out [m].
  double min_separation = 0.0;
  ManifoldPoint points[kMaxPoints];

  void add(const Vec3& position, double separation, std::uint32_t feature) {
    if (count < kMaxPoints) points[count++] = {position, separation, feature};
  }
};

// The contact points with a separation of at most margin. Precondition: not two half-spaces.
//
// The normal is that of the least penetration, or of the least distance of what is apart. Where a
// face does nearly as well (within 5% and 1e-5 of the smaller shape's size), its normal is taken
// and the patch that lies over it: manifolds of faces have several points and are steady.
void find_manifold(const Geometry& a, const SE3& T_a, const Geometry& b, const SE3& T_b,
                   double margin, PairCache& cache, Manifold& manifold);
// For those who ask once.
void find_manifold(const Geometry& a, const SE3& T_a, const Geometry& b, const SE3& T_b,
                   double margin, Manifold& manifold);

}  // namespace vp::collide
