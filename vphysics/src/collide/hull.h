// The data of a ConvexHull: constant once built, shared by all users of the hull.
#pragma once

#include <cstdint>
#include <vector>

#include "collide/hull_scan.h"
#include "vphysics/convex_hull.h"

namespace vp::collide {

// The vertices of larger hulls are not scanned, but searched from neighbour to neighbour.
inline constexpr std::size_t kMaxScanned = 64;

// An edge between two vertices, v0 < v1. Seen from outside, the face on its left has v0 before v1.
struct HullEdge {
  std::uint16_t v0, v1;
  std::uint16_t left, right;  // faces
  bool operator==(const HullEdge&) const = default;
};

struct HullData {
  std::vector<Vec3> vertices;
  // The vertices again, padded with the first; empty if they are more than kMaxScanned.
  ScanList scanned_vertices;
  std::vector<ConvexHull::Face> faces;  // sorted by their corners
  // Their planes again, padded with planes without a normal that nothing is in front of. A real
  // normal points more along any direction: the hull is closed.
  ScanPlanes scanned_faces;
  std::vector<std::uint16_t> corners;  // of all faces, face by face
  std::vector<HullEdge> edges;         // sorted by their vertices
  // The edge from each corner to the next of its face. Those of face f start at first_corner[f].
  std::vector<std::uint16_t> corner_edges, first_corner;
  // Faces and neighbours of vertex v: the range from first_around[v] to first_around[v + 1].
  std::vector<std::uint16_t> faces_around, neighbours, first_around;
  // Of a corner behind the plane of its face, the maximum. More than a rounding error only if faces
  // have been merged (HullOptions::tolerance).
  double max_face_depth = 0.0;
  Vec3 lower, upper;  // bounds
  Vec3 centre;        // of mass
  double radius;      // of the bounding sphere about centre
  double volume;
  Inertia unit;  // at density 1, about the frame's origin
};

}  // namespace vp::collide
