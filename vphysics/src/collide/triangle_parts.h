// Faces, edges and corners of a surface's triangles, and the directions in which they can be
// touched.
#pragma once

#include "collide/surface.h"

namespace vp::collide {

// Turns the triangle's front towards the point. Returns false if it is one-sided and the point is
// behind it.
bool face_towards(SurfaceTriangle& triangle, const Vec3& point, bool two_sided);

struct TrianglePart {
  enum Kind : std::uint8_t { face, edge, corner } kind = face;
  int index = 0;  // of the edge, from corner `index` to the next, or of the corner
};

struct NearestOnTriangle {
  Vec3 point;
  TrianglePart part;
};
NearestOnTriangle nearest_on_triangle(const Vec3 p[3], const Vec3& q);

// The part of the triangle that is farthest along the unit vector d.
TrianglePart foremost_part(const Vec3 p[3], const Vec3& d);

inline bool is_active_edge(const SurfaceTriangle& t, int edge) {
  return ((t.active >> edge) & 1u) != 0;
}
// Whether d, a unit vector away from the surface, may be a contact normal at that part: an edge or
// a corner must be active, and the surface there must be below the plane perpendicular to d.
bool may_touch_along(const Surface& surface, const SurfaceTriangle& triangle,
                     const TrianglePart& part, const Vec3& d);

}  // namespace vp::collide
