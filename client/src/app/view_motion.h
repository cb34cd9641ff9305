// How the camera moves: leaning a little towards the play, drifting on the logo, coming nearer for
// a choice. Always gently, so that a hand's aim is never disturbed.
#pragma once

#include "client/settings.h"
#include "render/camera.h"
#include "wire/snapshot.h"

namespace client {

class ViewMotion {
 public:
  // scene: null while nothing was received. dt [s]. shake 0..1: of a goal or a hard hit.
  CameraView step(const wire::Snapshot* scene, int team, float dt, float shake = 0.0f);
  // Camera of the view, from the last step.
  Camera camera(View view, const glm::ivec2& screen) const;

 private:
  CameraView view_;
  float drift_ = 0.0f;  // [s] on the logo
  float time_ = 0.0f;
  glm::vec3 ball_{0.0f};  // followed gently
};

}  // namespace client
