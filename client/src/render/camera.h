// A player's view: standing at the long side, own goal to the left, looking down at the whole
// table with its handles, wherever they are slid to, in windows of every shape.
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

inline constexpr float kMostLean = 0.030f;  // [m] along x: so far the whole table stays in view

struct CameraView {
  foosball::Layout layout = foosball::Layout::tournament;
  int team = 0;            // whose side; a watcher stands with team 0
  float orbit = 0.0f;      // turned about the table [rad]: the logo and the ceremony drift slowly
  float closeness = 0.0f;  // 0 whole table .. 1 near the men
  glm::vec2 lean{0.0f};    // of the gaze towards the play [m]
  glm::vec3 shake{0.0f};   // of the eye [m]
};

Camera player_camera(const CameraView& view, const glm::ivec2& screen);

// Straight down on a screen that lies in the table (the paper's cabinet): the field and the mouths
// of the goals as large as the screen allows, along its long side, without perspective, so that
// rods meet their handles outside. Team 0's side is at the bottom, or team 1's.
inline constexpr float kGoalMouth = 0.075f;  // [m] behind each goal line: a scored ball is seen
Camera above_camera(const foosball::TableSpec& table, int team, const glm::ivec2& screen);

// Behind the play, near, going with the ball; and a stand from which people watch, turned by
// `orbit`.
Camera follow_camera(const CameraView& view, const glm::vec3& ball, const glm::ivec2& screen);
Camera spectator_camera(const CameraView& view, const glm::ivec2& screen);

}  // namespace client
