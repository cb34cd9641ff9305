// Contact points between two overlapping features.
#pragma once

#include "collide/feature.h"
#include "collide/manifold.h"

namespace vp::collide {

// All in one frame.
struct PatchQuery {
  const Feature& a;
  const Feature& b;
  Vec3 normal;                // unit, from a to b
  double radius_a, radius_b;  // radii of the spheres that sweep the cores
  double margin;              // rejects points with a larger separation along the normal
  double size;                // scale of the tolerance for coincident points
  Vec3 on_a, on_b;            // the closest points of the cores, already found
  double core_separation;     // of the cores along the normal, at these points
};

// Appends at most four points. with_nearest: adds the closest points if they are within the margin
// and deeper than the features' points.
void find_patch(const PatchQuery& query, bool with_nearest, Manifold& manifold);

inline constexpr int kMaxPatch = 2 * kMaxCorners;

// No default initializers, as in FeatureCorner.
struct PatchPoint {
  double x, y, z, separation;
  std::uint32_t name;

  Vec3 at() const { return {x, y, z}; }
};

// Appends four corners of a convex patch, in their order around it, that preserve its extent; one
// of them is among the deepest. Precondition: at most kMaxPatch points.
void reduce_patch(const PatchPoint* points, int count, const Vec3& normal, double size,
                  Manifold& manifold);

}  // namespace vp::collide
