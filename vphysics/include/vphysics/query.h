// What a world is asked: rays, shapes cast through it, what touches, what is near.
#pragma once

#include <cstdint>
#include <functional>
#include <span>

#include "vphysics/ids.h"
#include "vphysics/lie.h"
#include "vphysics/shapes.h"

namespace vp {

// Which colliders are found.
struct QueryFilter {
  CollisionFilter collision{};        // those that would meet a collider with this filter
  bool sensors = false;               // sensors, too
  std::span<const BodyId> ignored{};  // but nothing of these bodies
  // Asked of all that pass the rest and may come into the answer, in no order; false leaves it out.
  // Must neither change nor ask the world. Empty: accepts all.
  std::function<bool(ColliderId collider, BodyId body, std::uint64_t user_data)> accepts{};
};

// A collider that was found.
struct QueryHit {
  ColliderId collider;
  BodyId body;
  std::uint64_t user_data;
  std::uint32_t part;  // of a compound, or a triangle of a mesh or a height field; 0 of others
};

struct RayHit : QueryHit {
  double distance;  // along the unit direction [m]; 0 where the ray starts inside
  Vec3 point;       // where the ray enters, world frame [m]
  Vec3 normal;  // unit, out of the collider, world frame; starting inside, of the nearest surface
};

// Where a shape goes: along a straight line, turning about its frame's origin.
struct CastMotion {
  Vec3 translation;  // world frame [m]
  Vec3 rotation;     // world frame [rad], axis times angle
};

struct ShapeHit : QueryHit {
  double fraction;    // of the motion, in [0, 1); 0 where the shape touches from the start
  double separation;  // there [m]: 0 but for rounding, or less where it overlaps from the start
  Vec3 point;         // on the collider, world frame [m]
  Vec3 normal;        // unit, out of the collider towards the shape, world frame
};

struct NearestHit : QueryHit {
  double distance;   // [m]; below zero, how far the shape has to be moved out
  Vec3 on_shape;     // world frame [m]
  Vec3 on_collider;  // the same
  Vec3 normal;       // unit, out of the collider towards the shape, world frame
};

}  // namespace vp
