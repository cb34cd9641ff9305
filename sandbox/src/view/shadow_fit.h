// The sun's camera: a box around the shadow casters. No OpenGL here.
#pragma once

#include <glm/mat4x4.hpp>
#include <glm/vec3.hpp>
#include <span>

namespace sandbox {

inline constexpr glm::vec3 kSunDirection{-0.4607f, -0.4959f, 0.7361f};  // unit, towards the sun

struct Caster {
  glm::vec3 centre;
  float radius;
};

struct ShadowFit {
  glm::mat4 matrix{1.0f};  // clip from positions
  float width = 1.0f;      // of the square that the map covers [m]
};

// around: casters farther than this from the origin are omitted if they would make the map coarse.
ShadowFit fit_shadow(std::span<const Caster> casters, float around);

}  // namespace sandbox
