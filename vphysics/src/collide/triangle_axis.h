// The exit axis of minimum penetration of a convex shape from a triangle of a surface.
#pragma once

#include "collide/gjk.h"
#include "collide/triangle_parts.h"

namespace vp::collide {

struct TriangleAxis {
  double separation;  // of the cores along the normal: negative if they overlap
  Vec3 normal;        // unit, from the triangle to the shape
  TrianglePart part;
};

// Considers the exit directions that the surface allows: along the face normal, across active
// edges, each from the one face's normal to the other's, and at their corners. The pair is the
// triangle, in the frame of p with its axes along the surface's, and the shape.
TriangleAxis best_exit_axis(const Surface& surface, const SurfaceTriangle& triangle,
                            const Vec3 p[3], const CorePair& pair);

}  // namespace vp::collide
