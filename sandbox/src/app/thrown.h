// The shapes that can be thrown into a scene: one of each kind that can move.
#pragma once

#include <array>

#include "vphysics/shapes.h"

namespace sandbox {

inline constexpr std::array<const char*, 6> kThrownNames{"box",      "sphere", "capsule",
                                                         "cylinder", "cone",   "hull"};
// About as large as a sphere of that radius [m]. Precondition: index is valid in kThrownNames.
vp::Shape thrown_shape(int index, double radius);

}  // namespace sandbox
