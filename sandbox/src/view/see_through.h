// Which fixed boxes stand in the way of seeing what moves, as the walls of a pit do. No OpenGL
// here.
#pragma once

#include <span>

#include "vphysics/shapes.h"

namespace sandbox {

// The straight way from a to b goes through the box, or begins or ends in it.
bool hides(const vp::Box& box, const vp::SE3& T_world_box, const vp::Vec3& a, const vp::Vec3& b);
// The box is in the way of more than a tenth of the points, seen from `from`.
bool hides_many(const vp::Box& box, const vp::SE3& T_world_box, const vp::Vec3& from,
                std::span<const vp::Vec3> points);

}  // namespace sandbox
