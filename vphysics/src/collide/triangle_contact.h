// One triangle of a surface against a convex shape.
//
// The normal of a contact is that of the face, unless an edge or a corner that can be felt is
// nearest and the surface there lies below the plane across the direction to the shape. So what
// slides over triangles that go on flat or upwards meets faces alone: what lies beyond such an edge
// is left to the neighbour.
#pragma once

#include <vector>

#include "collide/manifold.h"
#include "collide/triangle_parts.h"

namespace vp::collide {

// In the surface's frame.
struct TriangleContact {
  Vec3 normal;  // unit, from the triangle to the shape
  TrianglePart part;
  double separation;               // along the normal: less than 0, they overlap
  std::size_t first_point, count;  // in the vector that they were appended to
  // Of an edge the names of both corners, the lower one above the higher one, of a corner its name
  // twice; of a face kFace.
  std::uint64_t active_part;
  static constexpr std::uint64_t kFace = ~std::uint64_t{0};
  bool rough = false;  // CorePair::rough
};

// Appends the points of a separation of at most margin, not reduced, in the surface's frame.
// Features have names that are the same for all triangles that share the edge or corner touched.
// count 0: they do not touch. Precondition: the triangle faces the shape's middle; the shape is
// convex and no half-space.
TriangleContact collide_triangle(const Surface& surface, const SurfaceTriangle& triangle,
                                 const Geometry& shape, const SE3& T_surface_shape, double margin,
                                 std::vector<ManifoldPoint>& points);

// Distance from a sphere's centre to what of the triangle it would touch; kFar if what is nearest
// cannot be felt from there. Precondition: the triangle faces the centre.
double active_distance(const Surface& surface, const SurfaceTriangle& triangle, const Vec3& centre);

// Whether the shape, there, has a point in common with the triangle, more than touching.
bool overlaps_triangle(const SurfaceTriangle& triangle, const Geometry& shape,
                       const SE3& T_surface_shape);

}  // namespace vp::collide
