// Pulls a point of a body towards the pointer with a damped spring.
//
//   k = m w^2,  c = 2 m w        a critically damped spring of angular frequency w, if the body's
//                                whole mass were at that point
//   P = -dt (k (x - t + dt v') + c v'),  v' = v + K P
//
// Here x and v are the point's position and velocity, t the target and P the impulse of a step. K
// is the velocity change of the point per unit of impulse there: 1/m + [r]^T I^-1 [r]. Solving for
// P is implicit Euler: it is stable for every step length.
#pragma once

#include <optional>

#include "vphysics/world.h"

namespace sandbox {

struct Grip {
  vp::BodyId body;
  vp::Inertia inertia;  // of the body, about its origin
  vp::Vec3 point_body;  // in the body's frame
  vp::Vec3 target;      // target position of the point, world frame
};

// In the world frame; the force is limited to kStrongest times the body's weight. Precondition: the
// body exists and has mass.
vp::Vec3 pull_impulse(const vp::World& world, const Grip& grip, double dt);

}  // namespace sandbox
