#include "app/view_motion.h"

#include <algorithm>
#include <cmath>
#include <glm/common.hpp>

#include "foosball/table.h"
#include "render/hud.h"

namespace client {
namespace {

constexpr float kMaxShake = 0.006f;  // [m] of the eye
constexpr float kFollowS = 0.35f;    // [s] to close 63% of the distance to the ball
constexpr float kSettle = 1.1f;      // [s] to close most of the distance to the camera's target

}  // namespace

CameraView ViewMotion::step(const wire::Snapshot* scene, int team, float dt, float shake) {
  time_ += dt;
  const auto screen = scene != nullptr ? static_cast<ScreenKind>(scene->screen) : ScreenKind::logo;
  CameraView wanted;
  if (screen == ScreenKind::logo) {
    drift_ += dt;
    wanted.orbit = 0.35f * std::sin(0.12f * drift_);
    wanted.closeness = 0.1f;
  } else if (screen == ScreenKind::selection) {
    wanted.closeness = 0.62f;
  } else if (scene->ball_in_play) {
    const auto& table = foosball::table_spec(static_cast<foosball::Layout>(scene->layout));
    const float way = scene->ball.position[0] / static_cast<float>(0.5 * table.length);
    wanted.lean = {kMaxLean * std::clamp(way, -1.0f, 1.0f), 0.0f};
  }
  const float share = 1.0f - std::exp(-3.0f * dt / kSettle);
  if (scene != nullptr) view_.layout = static_cast<foosball::Layout>(scene->layout);
  view_.team = team;
  view_.orbit += share * (wanted.orbit - view_.orbit);
  view_.closeness += share * (wanted.closeness - view_.closeness);
  view_.lean += share * (wanted.lean - view_.lean);
  view_.shake =
      kMaxShake * shake *
      glm::vec3(std::sin(61.0f * time_), std::sin(47.0f * time_), std::sin(73.0f * time_));
  if (scene != nullptr && scene->ball_in_play) {
    const auto& at = scene->ball.position;
    ball_ += (1.0f - std::exp(-dt / kFollowS)) * (glm::vec3(at[0], at[1], 0.0f) - ball_);
  }
  return view_;
}

Camera ViewMotion::camera(View view, const glm::ivec2& screen) const {
  CameraView turned = view_;
  switch (view) {
    case View::above:
      return above_camera(foosball::table_spec(view_.layout), view_.team, screen);
    case View::follow:
      return view_.closeness > 0.2f ? player_camera(view_, screen)
                                    : follow_camera(view_, ball_, screen);
    case View::spectator:
      turned.orbit = 0.05f * time_;
      return spectator_camera(turned, screen);
    case View::seat:
      break;
  }
  return player_camera(view_, screen);
}

}  // namespace client
