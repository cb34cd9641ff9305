// Pulls one point of a body towards where the pointer is, as a damped spring does.
//
//   k = m w^2,  c = 2 m w        a spring of angular frequency w that damps critically, were all
//                                the body's mass in that point
//   P = -dt (k (x - t + dt v') + c v'),  v' = v + K P
//
// with x and v the point's position and velocity, t the target, P the impulse of a step, and K what
// an impulse there changes the velocity by: 1/m + [r]^T I^-1 [r]. Solved for P, which is implicit
// Euler: no step is too long for it.
#pragma once

#include <optional>

#include "vphysics/world.h"

namespace sandbox {

struct Grip {
  vp::BodyId body;
  vp::Inertia inertia;  // the body's, about its origin
  vp::Vec3 point_body;  // in the body's frame
  vp::Vec3 target;      // where it is wanted, world frame
};

// In the world's frame; never more than a force of kStrongest weights of the body.
// Precondition: the body exists and has mass.
vp::Vec3 pull_impulse(const vp::World& world, const Grip& grip, double dt);

}  // namespace sandbox
