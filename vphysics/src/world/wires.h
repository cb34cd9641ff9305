// Wireframes: the edges and outlines of shapes, as lines.
#pragma once

#include "vphysics/debug_draw.h"

namespace vp {

void draw_wire(const Shape& shape, const SE3& T_world_shape, double half_space_size,
               DebugCategory category, DebugDraw& draw);
// The twelve edges of a box.
void draw_box(const SE3& T_world_box, const Vec3& half_extents, DebugCategory category,
              DebugDraw& draw);

}  // namespace vp
