// How far two colliders may come nearer to one another within a step: what the narrow phase and the
// broad phase must search ahead.
#pragma once

#include "world/collider.h"
#include "world/loads.h"

namespace vp {

class Approach {
 public:
  // desc: its lengths in metres.
  Approach(const Bodies& bodies, const BodyLoads& loads, const WorldDesc& desc, double speed_unit,
           double dt)
      : bodies_(bodies), loads_(loads), desc_(desc), speed_unit_(speed_unit), dt_(dt) {}

  // What gravity and forces add to the body's velocity on the mean of the step, if that is more
  // than margins bear; else nothing, and the next step finds it by its velocity.
  Velocity pull_of(const Body& body) const;
  // The two close in by no more [m], as long as neither turns far: where they meet they move at the
  // velocities that they have there. And by no more than the balls around both do, and what
  // rotation moves within these.
  double of(const Collider& a, const Collider& b) const;

 private:
  const Bodies& bodies_;
  const BodyLoads& loads_;
  const WorldDesc& desc_;
  double speed_unit_, dt_;
};

}  // namespace vp
