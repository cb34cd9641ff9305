#include "render/camera.h"

#include <algorithm>
#include <cmath>
#include <glm/gtc/constants.hpp>
#include <glm/gtc/matrix_transform.hpp>

namespace client {
namespace {

constexpr float kElevation = 0.98f;  // [rad] above the field: the near wall hides little of it
constexpr float kDistance = 1.72f;   // [m] at the aspect below: the table and the near handles fit
constexpr float kGazeNear = 0.062f;  // [m] before the middle: the own handles are seen, not cut off
constexpr float kFieldOfView = 0.64f;    // [rad], vertical
constexpr float kAspect = 16.0f / 9.0f;  // narrower windows step back

}  // namespace

glm::vec3 Camera::project(const glm::vec3& world, const glm::ivec2& screen) const {
  const glm::vec4 clip = view_projection * glm::vec4(world, 1.0f);
  return {(0.5f + 0.5f * clip.x / clip.w) * static_cast<float>(screen.x),
          (0.5f - 0.5f * clip.y / clip.w) * static_cast<float>(screen.y), clip.w};
}

Camera player_camera(const CameraView& view, const glm::ivec2& screen) {
  const float aspect =
      static_cast<float>(std::max(screen.x, 1)) / static_cast<float>(std::max(screen.y, 1));
  const float distance =
      kDistance * std::max(1.0f, kAspect / aspect) * (1.0f - 0.45f * view.closeness);
  const float side = (view.team == 1 ? glm::half_pi<float>() : -glm::half_pi<float>()) + view.orbit;
  const float elevation = kElevation - 0.30f * view.closeness;
  const float toward = view.team == 1 ? 1.0f : -1.0f;
  const glm::vec3 target{view.lean.x, view.lean.y + toward * kGazeNear, 0.0f};
  Camera camera;
  camera.eye =
      target + distance * glm::vec3(std::cos(elevation) * std::cos(side),
                                    std::cos(elevation) * std::sin(side), std::sin(elevation));
  camera.view = glm::lookAt(camera.eye, target, glm::vec3(0, 0, 1));
  camera.projection = glm::perspective(kFieldOfView, aspect, 0.15f, 12.0f);
  camera.view_projection = camera.projection * camera.view;
  return camera;
}

}  // namespace client
