// Scenes whose end is known in closed form: who has them right has masses, moments of inertia,
// gravity, friction, restitution, launches, joints and their limits as the scenes say.
#pragma once

#include <span>
#include <vector>

#include "scenes/scene.h"

namespace scenes {

struct Expectation {
  const char* what;
  int body;
  Vec3 point;        // in the body's frame
  Vec3 expected;     // where it is at the scene's end, world frame
  double tolerance;  // [m]: for steps of 1/240 s, and contacts that give by a few millimetres
  // Of two bodies it is the mean of their points that is expected, with this share of the other's.
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
// Bodies that slide, roll, fall, collide, turn and are launched.
Touchstone touchstone();
// Pendulums on hinges and balls, and arms that fall onto the limits of their hinges.
Touchstone joined_touchstone();

}  // namespace scenes
