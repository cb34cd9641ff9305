// How far two colliders may come nearer to one another within a step: what the narrow phase and the
// broad phase must search ahead.
#pragma once

#include "world/collider.h"
#include "world/loads.h"

namespace vp {

struct Approach {
  const Bodies& bodies;
  const BodyLoads& loads;
  const WorldDesc& desc;  // its lengths in metres
  double speed_unit, dt;

  // What gravity and forces add to the body's velocity on the mean of the step, if that is more
  // than margins bear; else nothing, and the next step finds it by its velocity.
  Velocity pull_of(const Body& body) const;
  // The two close in by no more [m], as long as neither turns far: where they meet they move at the
  // velocities that they have there. And by no more than the balls around both do, and what
  // rotation moves within these.
  double of(const Collider& a, const Collider& b) const;
};

}  // namespace vp
