// Finds fixed boxes that hide moving bodies, such as the walls of a pit. No OpenGL here.
#pragma once

#include <span>

#include "vphysics/shapes.h"

namespace sandbox {

// The segment from a to b intersects the box.
bool hides(const vp::Box& box, const vp::SE3& T_world_box, const vp::Vec3& a, const vp::Vec3& b);
// The box hides more than a tenth of the points, seen from `from`.
bool hides_many(const vp::Box& box, const vp::SE3& T_world_box, const vp::Vec3& from,
                std::span<const vp::Vec3> points);

}  // namespace sandbox
