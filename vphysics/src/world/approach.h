// Bounds how far two colliders may approach each other within a step: the speculative margin of the
// narrow phase and the broad phase.
#pragma once

#include <optional>

#include "collide/impact_manifold.h"
#include "world/collider.h"
#include "world/loads.h"

namespace vp {

// A plane between two colliders.
struct Apart {
  Vec3 normal;      // unit, from a to b
  double distance;  // by which it separates them [m]
};

struct Approach {
  const Bodies& bodies;
  const BodyLoads& loads;
  const WorldDesc& desc;  // lengths in metres
  double speed_unit, dt;

  // The mean velocity change over the step from gravity and forces, if it exceeds what the margins
  // allow for. Otherwise zero: the next step accounts for it by the body's velocity.
  Velocity pull_of(const Body& body) const;
  // Upper bound of the approach of the two colliders [m]: the smaller of two bounds. The first
  // holds while neither rotates far: relative velocity of the bodies where the colliders would
  // touch. The second: relative velocity of the bounding spheres' centres, and the motion of each
  // shape within its sphere by rotation.
  double of(const Collider& a, const Collider& b) const;
  // The search distance of two convex colliders: `largest`, the one at rest and their approach.
  collide::PairMargin margin(const Collider& a, const Collider& b, double largest,
                             double at_rest) const;
  // The plane between their bounding spheres about the bodies' reference points, along the motion.
  // None if the spheres may come closer than `slack` within the step.
  std::optional<Apart> spheres_apart(const Collider& a, const Collider& b, double slack) const;
  // How far the two may move within the step beside their motion at their velocities [m].
  double pushed(const Collider& a, const Collider& b) const;
  // Their motion at the present velocities.
  collide::PairMotion motion(const Collider& a, const Collider& b, double tolerance) const;
};

}  // namespace vp
