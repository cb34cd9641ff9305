// How the camera moves: leaning a little towards the play, drifting on the logo, coming nearer for
// a choice. Always gently, so that a hand's aim is never disturbed.
#pragma once

#include "render/camera.h"
#include "wire/snapshot.h"

namespace client {

class ViewMotion {
 public:
  // scene: null while nothing was received. dt [s].
  CameraView step(const wire::Snapshot* scene, int team, float dt);

 private:
  CameraView view_;
  float drift_ = 0.0f;  // [s] on the logo
};

}  // namespace client
