// Manifolds of any two shapes: one for two convex shapes, any number if a shape has parts.
#pragma once

#include <span>
#include <vector>

#include "collide/impact_manifold.h"
#include "collide/manifold.h"
#include "collide/search_margin.h"
#include "collide/triangle_contact.h"

namespace vp::collide {

// Between a part of a and a part of b: a part of a compound, or a triangle of a mesh or a height
// field (among coplanar triangles, the one with the deepest point); 0 for other shapes.
struct SubManifold {
  Manifold manifold;
  std::uint32_t sub_a = 0, sub_b = 0;
  PairCache cache;  // if both parts are convex and not triangles
  MotionToImpact to_impact;
};

// Cached data of a sub-manifold from the last call for the same pair.
struct KnownPart {
  std::uint32_t sub_a, sub_b;
  PairCache cache;
};

// Scratch memory of find_manifolds, owned by the caller. It holds no data between calls.
struct ManifoldScratch {
  std::vector<std::uint32_t> triangles, near_triangles, parts;
  // For a surface: the contact of each triangle, and the index of the manifold (cluster) that it
  // becomes part of.
  struct Contact {
    TriangleContact contact;
    std::uint32_t triangle, cluster;
  };
  static constexpr std::uint32_t kNoTriangle = ~0u;
  std::vector<Contact> contacts;
  // The plane of each of `triangles`, and the shape's separation along its normal.
  struct Plane {
    Vec3 normal;
    double separation;
  };
  std::vector<Plane> planes;
  std::vector<ManifoldPoint> points;
  // By point, 1: a manifold contains or represents it.
  std::vector<std::uint8_t> converged;
  // Statistics: triangles_tested counts triangles; crowded: there were more normals than
  // kMaxClusters; rough: CorePair::rough was set for a triangle.
  std::uint32_t triangles_tested = 0;
  bool crowded = false, rough = false;

  // Reserves memory for more triangles than a shape touches, unless they are much smaller than the
  // shape. So a step with a new maximum does not allocate.
  void ensure_capacity() {
    triangles.reserve(512);
    near_triangles.reserve(512);
    contacts.reserve(128);
    planes.reserve(512);
    points.reserve(256);
    converged.reserve(256);
  }
};

// The maximum number of distinct normals between a surface and one convex shape.
inline constexpr std::size_t kMaxClusters = 12;

// Appends the manifolds with points of a separation of at most the margin, in an order that depends
// on the shapes and poses alone. Each part of a compound has its own; coplanar triangles, within 2
// degrees, share one. Feature names are unique among the manifolds of the pair, except for
// collisions with a probability of one in 2^32. cache is used if both shapes are convex; known, in
// any order, if they have parts. Two surfaces, or a surface and a half-space, have no manifolds. If
// the margin has a motion, those of convex parts that will collide are found where they will.
void find_manifolds(const Geometry& a, const SE3& T_a, const Geometry& b, const SE3& T_b,
                    const SearchMargin& margin, PairCache& cache, std::span<const KnownPart> known,
                    ManifoldScratch& scratch, std::vector<SubManifold>& manifolds);

// A lower bound of the distance of two shapes of which at least one has parts: the distance between
// the bounds of the nearest part and the bounds of the other shape [m]. 0 if it is not cheap to
// compute.
double distance_of_parts(const Geometry& a, const SE3& T_a, const Geometry& b, const SE3& T_b,
                         CastScratch& scratch);

// Whether a pair has one manifold per part, instead of one.
inline bool has_parts(const Geometry& a, const Geometry& b) {
  return a.kind >= Kind::mesh || b.kind >= Kind::mesh;
}
// The kind of a sub-shape: of a compound's part, or triangle.
Kind kind_of_part(const Geometry& geometry, std::uint32_t sub);
// An upper bound, exclusive, of the numbers of sub-shapes.
std::uint32_t number_of_parts(const Geometry& geometry);

}  // namespace vp::collide
