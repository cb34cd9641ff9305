// A player's view: from the long side, own goal at the left, looking down at the whole table. The
// handles stay in view at every slide and window shape.
#pragma once

#include <glm/mat4x4.hpp>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

#include "foosball/table.h"

namespace client {

struct Camera {
  glm::vec3 eye{0.0f};
  glm::mat4 view{1.0f};
  glm::mat4 projection{1.0f};
  glm::mat4 view_projection{1.0f};

  // Pixel from the top left, and the depth along the view [m] (not positive: behind the eye).
  glm::vec3 project(const glm::vec3& world, const glm::ivec2& screen) const;
};

inline constexpr float kMaxLean = 0.030f;  // [m] along x, maximum with the whole table in view

struct CameraView {
  foosball::Layout layout = foosball::Layout::tournament;
  int team = 0;        // side of the camera; a watcher stands with team 0
  float orbit = 0.0f;  // rotation about the table [rad]: drifts on the logo and ceremony screens
  float closeness = 0.0f;  // 0 whole table .. 1 close to the men
  glm::vec2 lean{0.0f};    // offset of the look-at point towards the play [m]
  glm::vec3 shake{0.0f};   // offset of the eye [m]
};

Camera player_camera(const CameraView& view, const glm::ivec2& screen);

// Orthographic view straight down, for a screen that lies in the table (the paper's cabinet). The
// field and the goal mouths fill the screen as far as it allows, along its long side, so that rods
// line up with their handles outside. Team 0's side is at the bottom, or team 1's.
inline constexpr float kGoalMouth = 0.075f;  // [m] behind each goal line: shows a scored ball
Camera above_camera(const foosball::TableSpec& table, int team, const glm::ivec2& screen);

// follow_camera: close behind the ball, moving with it. spectator_camera: from the stand, rotated
// by `orbit`.
Camera follow_camera(const CameraView& view, const glm::vec3& ball, const glm::ivec2& screen);
Camera spectator_camera(const CameraView& view, const glm::ivec2& screen);

}  // namespace client
