// Contact of one triangle of a surface with a convex shape.
//
// The normal is that of the face. The exception: an active edge or corner is closest, and the
// surface there is below the plane perpendicular to the direction to the shape. So a shape that
// slides over triangles that continue flat or upwards touches faces alone. The region beyond such
// an edge belongs to the neighbour.
#pragma once

#include <vector>

#include "collide/manifold.h"
#include "collide/polytope.h"
#include "collide/triangle_parts.h"

namespace vp::collide {

// In the surface's frame.
struct TriangleContact {
  Vec3 normal;  // unit, from the triangle to the shape
  TrianglePart part;
  double separation;               // along the normal: negative if they overlap
  std::size_t first_point, count;  // in the vector that they were appended to
  // For an edge the names of both corners, the lower one in the upper half; for a corner its name
  // twice; for a face kFace.
  std::uint64_t active_part;
  static constexpr std::uint64_t kFace = ~std::uint64_t{0};
  bool rough = false;  // CorePair::rough
};

// A convex shape that is tested with many triangles. `faces`: if has_few_flat_faces(), else null.
struct ShapeOnSurface {
  const Geometry& shape;
  const SE3& T_surface_shape;
  const Polytope* faces;
};

// Appends the points of a separation of at most margin, not reduced, in the surface's frame.
// Triangles that share the touched edge or corner give the same feature names. count 0: no contact.
// Precondition: the triangle's front faces the shape's centre; the shape is convex and no
// half-space.
TriangleContact collide_triangle(const Surface& surface, const SurfaceTriangle& triangle,
                                 const ShapeOnSurface& shape, double margin,
                                 std::vector<ManifoldPoint>& points);

// Their distance, if it is at most limit, and its direction from the triangle to the shape; 0 if
// they overlap.
struct TriangleDistance {
  double distance;  // > limit: at least this
  Vec3 normal;      // unit, if they are separated
};
TriangleDistance distance_from_triangle(const SurfaceTriangle& triangle,
                                        const ShapeOnSurface& shape, double limit);
// The separation along a unit vector n from the triangle to the shape.
double separation_from_triangle(const SurfaceTriangle& triangle, const ShapeOnSurface& shape,
                                const Vec3& n);

// The distance from a sphere's centre to the part of the triangle that it would touch; kFar if the
// closest part is not active from there. Precondition: the triangle's front faces the centre.
double active_distance(const Surface& surface, const SurfaceTriangle& triangle, const Vec3& centre);

// Whether the shape overlaps the triangle by more than touching.
bool overlaps_triangle(const SurfaceTriangle& triangle, const ShapeOnSurface& shape);

}  // namespace vp::collide
