// Colours of bodies, linear, and of marks, as the screen shows them.
#pragma once

#include <array>
#include <cstddef>
#include <glm/vec3.hpp>
#include <glm/vec4.hpp>

namespace sandbox {

inline constexpr glm::vec4 kContactColour{1.0f, 0.83f, 0.10f, 1.0f},
    kHitColour{1.0f, 0.25f, 0.1f, 1.0f}, kCentreColour{0.05f, 0.05f, 0.05f, 1.0f},
    kGripColour{1.0f, 1.0f, 1.0f, 1.0f};
inline constexpr std::array<glm::vec4, 3> kAxisColours{
    {{0.90f, 0.20f, 0.20f, 1.0f}, {0.25f, 0.75f, 0.25f, 1.0f}, {0.25f, 0.45f, 0.95f, 1.0f}}};

// linear rgb; a: gloss
glm::vec4 body_colour(std::size_t index);
glm::vec4 speed_colour(double speed);  // [m/s]; full red from 10 m/s on
inline constexpr glm::vec4 kFixedColour{0.40f, 0.41f, 0.43f, 0.3f};
inline constexpr glm::vec4 kKinematicColour{0.16f, 0.13f, 0.26f, 0.8f};
inline constexpr glm::vec4 kHeldColour{0.95f, 0.80f, 0.30f, 1.0f};

}  // namespace sandbox
