// What a ConvexHull holds: constant once built, shared by everything that uses the hull.
#pragma once

#include <cstdint>
#include <vector>

#include "vphysics/convex_hull.h"

namespace vp::collide {

// Between two vertices, v0 < v1. Seen from outside, the face on its left has v0 before v1.
struct HullEdge {
  std::uint16_t v0, v1;
  std::uint16_t left, right;  // faces
  bool operator==(const HullEdge&) const = default;
};

struct HullData {
  std::vector<Vec3> vertices;
  std::vector<ConvexHull::Face> faces;  // sorted by their corners
  std::vector<std::uint16_t> corners;   // of all faces, one face after the other
  std::vector<HullEdge> edges;          // sorted by their vertices
  // Faces around each vertex: around[first_around[v]] up to around[first_around[v + 1] - 1]
  std::vector<std::uint16_t> around, first_around;
  Vec3 lower, upper;  // bounds
  Vec3 centre;        // of mass
  double radius;      // of the sphere about it that holds the hull
  double volume;
  Inertia unit;  // of density 1, about the frame's origin
};

}  // namespace vp::collide
