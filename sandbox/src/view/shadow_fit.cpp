#include "view/shadow_fit.h"

#include <algorithm>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/gtc/matrix_transform.hpp>

namespace sandbox {

// The map's size changes in steps, so that shadows do not shimmer with every moving body.
ShadowFit fit_shadow(std::span<const Caster> casters, float around) {
  constexpr float kStep = 1.12f;
  const glm::mat4 view = glm::lookAt(kSunDirection, glm::vec3(0.0f), glm::vec3(0, 0, 1));
  glm::vec3 low(1e30f), high(-1e30f);
  for (const Caster& caster : casters) {
    if (glm::length(caster.centre) > around) continue;
    const glm::vec3 p = glm::vec3(view * glm::vec4(caster.centre, 1.0f));
    low = glm::min(low, p - caster.radius);
    high = glm::max(high, p + caster.radius);
  }
  if (low.x > high.x) low = glm::vec3(-1.0f), high = glm::vec3(1.0f);
  const glm::vec3 middle = 0.5f * (low + high);
  const float needed = 0.5f * std::max(high.x - low.x, high.y - low.y);
  const float half = std::pow(kStep, std::ceil(std::log(needed) / std::log(kStep)));
  // Shadow receivers may be far below the casters.
  const float near = -high.z - 1.0f, far = -low.z + 8.0f * half + 1.0f;
  ShadowFit fit;
  fit.matrix =
      glm::ortho(middle.x - half, middle.x + half, middle.y - half, middle.y + half, near, far) *
      view;
  fit.width = 2.0f * half;
  return fit;
}

}  // namespace sandbox
