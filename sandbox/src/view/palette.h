// Colours of bodies, in linear light, and of marks, in sRGB.
#pragma once

#include <cstddef>
#include <glm/vec3.hpp>
#include <glm/vec4.hpp>

#include "vphysics/debug_draw.h"

namespace sandbox {

inline constexpr glm::vec4 kGripColour{1.0f, 1.0f, 1.0f, 1.0f};
glm::vec4 mark_colour(vp::DebugCategory mark);

// linear rgb; a: gloss
glm::vec4 body_colour(std::size_t index);
glm::vec4 speed_colour(double speed);  // [m/s]; full red from 10 m/s
inline constexpr glm::vec4 kFixedColour{0.40f, 0.41f, 0.43f, 0.3f};
inline constexpr glm::vec4 kKinematicColour{0.16f, 0.13f, 0.26f, 0.8f};
inline constexpr glm::vec4 kHeldColour{0.95f, 0.80f, 0.30f, 1.0f};

}  // namespace sandbox
