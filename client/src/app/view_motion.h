// Camera motion: leans a little towards the play, drifts on the logo screen, moves closer for the
// selection. The motion is always slow, so that it never disturbs a person's aim.
#pragma once

#include "client/settings.h"
#include "render/camera.h"
#include "wire/snapshot.h"

namespace client {

class ViewMotion {
 public:
  // scene: null before a snapshot is received. dt [s]. shake 0..1: from a goal or a hard hit.
  CameraView step(const wire::Snapshot* scene, int team, float dt, float shake = 0.0f);
  // Camera of the view, from the last step().
  Camera camera(View view, const glm::ivec2& screen) const;

 private:
  CameraView view_;
  float drift_ = 0.0f;  // [s] on the logo screen
  float time_ = 0.0f;
  glm::vec3 ball_{0.0f};  // the ball's position, low-pass filtered
};

}  // namespace client
