// A common view of boxes and hulls: vertices, faces and edges.
#pragma once

#include <array>
#include <cstdint>
#include <span>

#include "collide/geometry.h"

namespace vp::collide {

// Refers to a hull's own data, or to a box's generated data.
struct Polytope {
  std::span<const Vec3> vertices;
  std::span<const ConvexHull::Face> faces;
  std::span<const HullEdge> edges;
  const ScanPlanes* planes;  // of the faces; null for a box
};
// The first of the faces whose normals point farthest along d.
int face_towards(const Polytope& p, const Vec3& d);
// Whether the face's plane has both x and y in front of it, farther than `distance`.
inline bool is_behind(const ConvexHull::Face& face, const Vec3& x, const Vec3& y, double distance) {
  return dot(face.normal, x) - face.offset > distance &&
         dot(face.normal, y) - face.offset > distance;
}
// A bit for each such face of the kScanBits from index `first` on. Precondition: first is a
// multiple of kScanBits.
std::uint64_t faces_behind(const Polytope& p, std::size_t first, const Vec3& x, const Vec3& y,
                           double distance);

inline bool is_polytope(const Geometry& g) {
  return g.kind == Kind::box || g.kind == Kind::hull;
}

// A box is numbered as the hull of its corners: corner 4 x + 2 y + z, each 0 or 1.
inline constexpr std::uint16_t kBoxCorners[6][4] = {{0, 1, 3, 2}, {0, 2, 6, 4}, {0, 4, 5, 1},
                                                    {1, 5, 7, 3}, {2, 3, 7, 6}, {4, 6, 7, 5}};
inline constexpr HullEdge kBoxEdges[12] = {{0, 1, 0, 2}, {0, 2, 1, 0}, {0, 4, 2, 1}, {1, 3, 0, 3},
                                           {1, 5, 3, 2}, {2, 3, 4, 0}, {2, 6, 1, 4}, {3, 7, 4, 3},
                                           {4, 5, 2, 5}, {4, 6, 5, 1}, {5, 7, 3, 5}, {6, 7, 5, 4}};
inline constexpr std::uint16_t kBoxCornerEdges[6][4] = {
    {0, 3, 5, 1}, {1, 6, 9, 2}, {2, 8, 4, 0}, {4, 10, 7, 3}, {5, 7, 11, 6}, {9, 11, 10, 8}};
// The axis and the side of each face.
inline constexpr int kBoxFaceAxis[6] = {0, 2, 1, 2, 1, 0};
inline constexpr double kBoxFaceSide[6] = {-1, -1, -1, 1, 1, 1};
// The faces whose outward normals point along the negative and the positive direction of an axis.
inline constexpr int kBoxFace[3][2] = {{0, 5}, {2, 4}, {1, 3}};
inline Vec3 box_corner(const Vec3& half, int corner) {
  return {corner & 4 ? half.x : -half.x, corner & 2 ? half.y : -half.y,
          corner & 1 ? half.z : -half.z};
}

// Storage for the view of a box. Not copyable: the view points into it.
class PolytopeOf {
 public:
  explicit PolytopeOf(const Geometry& g);
  PolytopeOf(const PolytopeOf&) = delete;
  PolytopeOf& operator=(const PolytopeOf&) = delete;
  const Polytope& view() const { return view_; }

 private:
  Polytope view_;
  std::array<Vec3, 8> vertices_;
  std::array<ConvexHull::Face, 6> faces_;
};

}  // namespace vp::collide
