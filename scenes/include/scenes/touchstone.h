// Scenes with a closed-form final state. An engine that reaches it has masses, moments of inertia,
// gravity, friction, restitution, launches, joints and joint limits as the scenes define them.
#pragma once

#include <span>
#include <vector>

#include "scenes/scene.h"

namespace scenes {

struct Expectation {
  const char* what;
  int body;
  Vec3 point;        // in the body frame
  Vec3 expected;     // its position at the scene's end, world frame
  double tolerance;  // [m]: for steps of 1/240 s, and contacts that penetrate a few millimetres
  // With a second body, the expected point is the mean of both bodies' points; `share` is the
  // weight of the other body's point.
  int other = -1;
  double share = 0.0;

  double off(std::span<const SE3> poses) const {
    Vec3 at = poses[body] * point;
    if (other >= 0) at = (1.0 - share) * at + share * (poses[other] * point);
    return norm(at - expected);
  }
};
struct Touchstone {
  Scene scene;
  std::vector<Expectation> expectations;
};
// Bodies that slide, roll, fall, collide, rotate and are launched.
Touchstone touchstone();
// Pendulums on hinges and ball joints, and arms that fall onto the limits of their hinges.
Touchstone joined_touchstone();

}  // namespace scenes
