// Along which way out a convex shape is least deep in a triangle of a surface.
#pragma once

#include "collide/gjk.h"
#include "collide/triangle_parts.h"

namespace vp::collide {

struct TriangleAxis {
  double separation;  // of the cores along the normal: less than 0, they overlap
  Vec3 normal;        // unit, from the triangle to the shape
  TrianglePart part;
};

// Of the ways out that the surface allows: over the face, across the edges that can be felt, each
// from the one face's normal to the other's, and over their corners. The pair is of the triangle,
// in the frame of p with its axes along the surface's, and the shape.
TriangleAxis best_exit_axis(const Surface& surface, const SurfaceTriangle& triangle,
                            const Vec3 p[3], const CorePair& pair);

}  // namespace vp::collide
