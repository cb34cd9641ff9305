// Queries of a world: ray casts, shape casts, overlap tests, nearest colliders.
#pragma once

#include <cstdint>
#include <functional>
#include <span>

#include "vphysics/ids.h"
#include "vphysics/lie.h"
#include "vphysics/shapes.h"

namespace vp {

// Which colliders a query finds.
struct QueryFilter {
  CollisionFilter collision{};        // colliders that would collide with a collider of this filter
  bool sensors = false;               // include sensors
  std::span<const BodyId> ignored{};  // exclude all colliders of these bodies
  // Called, in no particular order, for colliders that pass the rest of the filter and may be part
  // of the result. Returning false excludes the collider. Must neither change nor query the world.
  // Empty: accepts all.
  std::function<bool(ColliderId collider, BodyId body, std::uint64_t user_data)> accepts{};
};

// The collider that a query found.
struct QueryHit {
  ColliderId collider;
  BodyId body;
  std::uint64_t user_data;
  // Index of a compound's part, or of a triangle of a mesh or a height field; else 0.
  std::uint32_t part;
};

struct RayHit : QueryHit {
  double distance;  // along the unit direction [m]; 0 if the ray starts inside
  Vec3 point;       // where the ray enters, world frame [m]
  Vec3 normal;  // unit, outward from the collider, world frame; if the ray starts inside: of the
                // nearest surface
};

// The motion of a shape cast: a straight translation, with a rotation about the shape frame's
// origin.
struct CastMotion {
  Vec3 translation;  // world frame [m]
  Vec3 rotation;     // world frame [rad], axis times angle
};

struct ShapeHit : QueryHit {
  double fraction;    // of the motion, in [0, 1); 0 if the shape touches at the start
  double separation;  // at that fraction [m]: 0 to rounding, or negative if the shapes overlap at
                      // the start
  Vec3 point;         // on the collider, world frame [m]
  Vec3 normal;        // unit, from the collider towards the shape, world frame
};

struct NearestHit : QueryHit {
  double distance;   // [m]; if negative, the penetration depth
  Vec3 on_shape;     // world frame [m]
  Vec3 on_collider;  // world frame [m]
  Vec3 normal;       // unit, from the collider towards the shape, world frame
};

}  // namespace vp
