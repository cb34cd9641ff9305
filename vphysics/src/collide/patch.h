// Where two features lie over one another: the contact points between them.
#pragma once

#include "collide/feature.h"
#include "collide/manifold.h"

namespace vp::collide {

// Everything in one frame.
struct PatchQuery {
  const Feature& a;
  const Feature& b;
  Vec3 normal;                // unit, from a to b
  double radius_a, radius_b;  // what the cores are swept by
  double margin;              // points farther apart than this along the normal are left out
  double size;                // size by which "the same place" is measured
  Vec3 on_a, on_b;            // nearest points of the cores, as found
  double core_separation;     // of the cores along the normal, at these points
};

// Appends at most four points. If the nearest points are asked for, and lie within the margin but
// deeper than what the features give, they are one of them.
void find_patch(const PatchQuery& query, bool with_nearest, Manifold& manifold);

inline constexpr int kMaxPatch = 2 * kMaxCorners;

// No defaults, as of FeatureCorner.
struct PatchPoint {
  double x, y, z, separation;
  std::uint32_t name;

  Vec3 at() const { return {x, y, z}; }
};

// Appends four of the corners of a convex patch, in their order around it, that keep its extent;
// one of them is one of the deepest. At most kMaxPatch.
void reduce_patch(const PatchPoint* points, int count, const Vec3& normal, double size,
                  Manifold& manifold);

}  // namespace vp::collide
