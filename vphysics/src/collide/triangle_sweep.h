// Contact of one triangle of a surface with a convex shape that moves, where they will touch.
//
// Taken now, the contact of a shape with a triangle that it only passes, or reaches beside another
// one, is a plane that it does not meet.
#pragma once

#include "collide/search_margin.h"
#include "collide/triangle_contact.h"

namespace vp::collide {

// As collide_triangle, for what may touch within the margin: of the surface and the shape, in that
// order and frame. The contact is found at the pose of the impact, and its points are moved back
// with the shape's centre.
TriangleContact sweep_triangle(const Surface& surface, const SurfaceTriangle& triangle,
                               const ShapeOnSurface& shape, const SweptMargin& margin,
                               std::vector<ManifoldPoint>& points);

}  // namespace vp::collide
