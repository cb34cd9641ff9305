// Manifolds between a surface and a convex shape.
#pragma once

#include "collide/manifolds.h"

namespace vp::collide {

// Appends manifolds in the surface's frame, with normals from the surface to the shape; sub_a is a
// triangle. margin: of the surface and the shape, in that order and frame.
void collide_surface(const Surface& surface, const Geometry& shape, const SE3& T_surface_shape,
                     const SweptMargin& margin, ManifoldScratch& scratch,
                     std::vector<SubManifold>& manifolds);

}  // namespace vp::collide
