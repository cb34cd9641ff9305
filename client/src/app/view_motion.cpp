#include "app/view_motion.h"

#include <algorithm>
#include <cmath>
#include <glm/common.hpp>

#include "foosball/table.h"
#include "render/hud.h"

namespace client {
namespace {

constexpr float kSettle = 1.1f;  // [s] to close most of the way to where the camera wants to be

}  // namespace

CameraView ViewMotion::step(const wire::Snapshot* scene, int team, float dt) {
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
    wanted.lean = {kMostLean * std::clamp(way, -1.0f, 1.0f), 0.0f};
  }
  const float share = 1.0f - std::exp(-3.0f * dt / kSettle);
  if (scene != nullptr) view_.layout = static_cast<foosball::Layout>(scene->layout);
  view_.team = team;
  view_.orbit += share * (wanted.orbit - view_.orbit);
  view_.closeness += share * (wanted.closeness - view_.closeness);
  view_.lean += share * (wanted.lean - view_.lean);
  return view_;
}

}  // namespace client
