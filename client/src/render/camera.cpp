#include "render/camera.h"

#include <algorithm>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/gtc/constants.hpp>
#include <glm/gtc/matrix_transform.hpp>
#include <vector>

#include "render/table_mesh.h"

namespace client {
namespace {

// View of the whole table. From lower, the men of one rod would hide each other and the ball. From
// higher, the travel of the goalies' handles, which is longer than the field, would make it small.
constexpr float kElevation = 0.74f;       // [rad] above the field
constexpr float kFieldOfView = 0.50f;     // [rad], vertical
constexpr float kShareOfPicture = 0.97f;  // fraction of the picture's half that the table may take

// View of the men, for the selection.
constexpr float kNearElevation = 0.80f;  // [rad]
constexpr float kNearDistance = 1.07f;   // [m] at the aspect below; larger in narrower windows
constexpr float kNearGaze = 0.06f;       // [m] in front of the centre
constexpr float kNearAspect = 16.0f / 9.0f;

// Closer to the play than the seat; and from the stand, lower than a player's view.
constexpr float kFollowElevation = 0.95f;     // [rad]
constexpr float kFollowDistance = 1.7f;       // [m]
constexpr float kSpectatorElevation = 0.55f;  // [rad]
constexpr float kSpectatorDistance = 2.5f;    // [m]

struct Stand {
  float distance;  // from the eye to the look-at point on the field [m]
  float gaze;      // distance of that point in front of the centre [m]
};

// The points that must be in the picture, seen by team 0; the table looks the same from the other
// side.
std::vector<glm::vec3> outermost_points(const foosball::TableSpec& table) {
  std::vector<glm::vec3> points;
  const Extent body = table_extent(table);
  for (const float x : {body.low.x, body.high.x}) {
    for (const float y : {body.low.y, body.high.y}) {
      for (const float z : {body.low.z, body.high.z}) points.emplace_back(x, y, z);
    }
  }
  for (int rod = 0; rod < foosball::kRods; ++rod) {
    const auto x = static_cast<float>(table.rods[static_cast<std::size_t>(rod)].x);
    const auto z = static_cast<float>(table.rod_height);
    for (const float dx : {-kHandleRadius, kHandleRadius}) {
      for (const float dz : {-kHandleRadius, kHandleRadius})
        points.emplace_back(x + dx, handle_reach(table, rod), z + dz);
    }
  }
  return points;
}

// The closest stand from which all points are in view. With the eye at (0, forward, up) along the
// view's axes, a point at (x, f, u) is in view if |x| <= (f - forward) tan_x and |u - up| <= (f -
// forward) tan_y. These are linear in the eye, so the outermost points of the four sides determine
// it.
Stand whole_table(const foosball::TableSpec& table, float aspect) {
  const glm::vec2 forward{std::cos(kElevation), -std::sin(kElevation)};  // in the plane of y and z
  const glm::vec2 up{-forward.y, forward.x};
  const float tan_y = kShareOfPicture * std::tan(0.5f * kFieldOfView);
  const float tan_x = aspect * tan_y;
  float top = -1e9f, bottom = -1e9f, side = -1e9f;
  for (const glm::vec3& point : outermost_points(table)) {
    const glm::vec2 p{point.y, point.z};
    const float f = glm::dot(p, forward), u = glm::dot(p, up);
    top = std::max(top, u - tan_y * f);
    bottom = std::max(bottom, -u - tan_y * f);
    side = std::max(side, std::abs(point.x) + kMaxLean - tan_x * f);
  }
  const float back = std::max((top + bottom) / (2.0f * tan_y), side / tan_x);
  const glm::vec2 eye = 0.5f * (top - bottom) * up - back * forward;
  const float distance = eye.y / -forward.y;
  return {distance, -(eye.x + distance * forward.x)};
}

float aspect_of(const glm::ivec2& screen) {
  return static_cast<float>(std::max(screen.x, 1)) / static_cast<float>(std::max(screen.y, 1));
}

Camera looking(const glm::vec3& eye, const glm::vec3& target, const glm::vec3& up,
               const glm::mat4& projection) {
  Camera camera;
  camera.eye = eye;
  camera.view = glm::lookAt(eye, target, up);
  camera.projection = projection;
  camera.view_projection = projection * camera.view;
  return camera;
}

}  // namespace

glm::vec3 Camera::project(const glm::vec3& world, const glm::ivec2& screen) const {
  const glm::vec4 clip = view_projection * glm::vec4(world, 1.0f);
  return {(0.5f + 0.5f * clip.x / clip.w) * static_cast<float>(screen.x),
          (0.5f - 0.5f * clip.y / clip.w) * static_cast<float>(screen.y), clip.w};
}

Camera player_camera(const CameraView& view, const glm::ivec2& screen) {
  const float aspect = aspect_of(screen);
  const Stand whole = whole_table(foosball::table_spec(view.layout), aspect);
  const float near = kNearDistance * std::max(1.0f, kNearAspect / aspect);
  const float distance = glm::mix(whole.distance, near, view.closeness);
  const float elevation = glm::mix(kElevation, kNearElevation, view.closeness);
  const float gaze = glm::mix(whole.gaze, kNearGaze, view.closeness);
  const float toward = view.team == 1 ? 1.0f : -1.0f;
  const float side = toward * glm::half_pi<float>() + view.orbit;
  const glm::vec3 target{view.lean.x, view.lean.y + toward * gaze, 0.0f};
  const glm::vec3 eye =
      target + distance * glm::vec3(std::cos(elevation) * std::cos(side),
                                    std::cos(elevation) * std::sin(side), std::sin(elevation));
  return looking(eye + view.shake, target, glm::vec3(0, 0, 1),
                 glm::perspective(kFieldOfView, aspect, 0.15f, 12.0f));
}

Camera above_camera(const foosball::TableSpec& table, int team, const glm::ivec2& screen) {
  constexpr float kEdge = 0.004f;  // [m] of the rim around the field
  const float aspect = aspect_of(screen);
  const auto half_x = static_cast<float>(0.5 * table.length) + kGoalMouth;
  const float half_y = static_cast<float>(0.5 * table.width) + kEdge;
  const float half_height = std::max(half_y, half_x / aspect);
  const glm::vec3 up{0.0f, team == 1 ? -1.0f : 1.0f, 0.0f};
  return looking({0, 0, 2.0f}, glm::vec3(0), up,
                 glm::ortho(-aspect * half_height, aspect * half_height, -half_height, half_height,
                            0.5f, 4.0f));
}

Camera follow_camera(const CameraView& view, const glm::vec3& ball, const glm::ivec2& screen) {
  const float aspect = aspect_of(screen), toward = view.team == 1 ? 1.0f : -1.0f;
  // Limits the motion to the side, so that the own rods stay in the picture.
  const glm::vec3 target{0.72f * ball.x, 0.35f * ball.y, 0.0f};
  const float distance = kFollowDistance * std::max(1.0f, kNearAspect / aspect);
  const glm::vec3 eye = target + distance * glm::vec3(0.0f, toward * std::cos(kFollowElevation),
                                                      std::sin(kFollowElevation));
  return looking(eye + view.shake, target, glm::vec3(0, 0, 1),
                 glm::perspective(kFieldOfView, aspect, 0.15f, 12.0f));
}

Camera spectator_camera(const CameraView& view, const glm::ivec2& screen) {
  const float aspect = aspect_of(screen);
  const float distance = kSpectatorDistance * std::max(1.0f, kNearAspect / aspect);
  const float side = -glm::half_pi<float>() + 0.9f * std::sin(view.orbit);
  const glm::vec3 target{0.0f, 0.0f, 0.02f};
  const glm::vec3 eye =
      target + distance * glm::vec3(std::cos(kSpectatorElevation) * std::cos(side),
                                    std::cos(kSpectatorElevation) * std::sin(side),
                                    std::sin(kSpectatorElevation));
  return looking(eye, target, glm::vec3(0, 0, 1),
                 glm::perspective(kFieldOfView, aspect, 0.15f, 12.0f));
}

}  // namespace client
