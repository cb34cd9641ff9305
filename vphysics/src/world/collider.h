// A collider, as the world keeps it, and pairs of colliders.
#pragma once

#include <cstdint>

#include "collide/bounds.h"
#include "collide/geometry.h"
#include "vphysics/world.h"
#include "world/body.h"
#include "world/slots.h"

namespace vp {

inline constexpr double kEndless = 1e30;  // a radius [m]

// What is read of a collider whenever one of its contacts is looked at comes first.
struct alignas(64) Collider {
  std::uint32_t body = kNone;
  std::uint32_t proxy = kNone;  // in the broad phase
  bool alive = false;
  bool sensor = false;
  bool stray = false;          // out of its proxy's bounds: find_strays()
  std::uint32_t next = kNone;  // of the same body
  // Half of its least extent [m], of a compound that of its smallest part; 0: what has none, as
  // half-spaces, meshes and height fields.
  double size = 0.0;
  // A ball around it, body frame; of a half-space without end.
  double radius = kEndless;
  Vec3 centre;
  std::uint32_t generation = 0;
  std::uint32_t serial = 0;  // order of creation

  collide::Geometry geometry;
  // Follows from the body's pose, the one of that number; refreshed by the step (Body::posed).
  std::uint64_t posed_for = 0;
  SE3 T;
  Material material;
  Vec3 surface_velocity;  // shape's frame
  collide::Bounds bounds;
  SE3 T_body_shape;
  CollisionFilter filter;
  double density = 0.0;  // [kg/m^3]
  // Of a link that moves along and about a line alone, as Body::around_line.
  collide::Bounds around_line;
  std::uint64_t user_data = 0;
  Shape shape = HalfSpace{};  // owns what geometry points to
};

using Colliders = Slots<Collider, ColliderId>;

// The poses and bounds of a body's colliders, where it is.
void pose_collider(const Body& body, Collider& collider);
void pose_colliders(Body& body, Colliders& colliders);
const collide::Bounds& bounds_at_pose(Body& body, Colliders& colliders);
// Adds a collider to what its body has of all its colliders. line: of a link that moves along and
// about a line alone, that line; else zero.
void note_collider(Body& body, Collider& collider, const Vec3& line);
// Of a body's solid colliders, but one.
Inertia inertia_of_colliders(const Body& body, const Colliders& colliders,
                             std::uint32_t without = kNone);

// In order of creation.
struct ColliderPair {
  std::uint64_t key;
  std::uint32_t a, b;
};

// Orders a pair by creation.
ColliderPair make_pair(const Colliders& colliders, std::uint32_t i, std::uint32_t j);
bool should_collide(const Collider& a, const Collider& b);

// The ball around the smaller of two colliders, where they meet if they do. World frame. The one
// rule of how near they come: relative velocity at its centre, and relative rotation times its
// radius.
struct Vicinity {
  Vec3 centre;
  double radius;  // 0 if the smaller is a ball itself: it is met along the line through its centre
  bool of_compound;  // the smaller is one
};

Vicinity vicinity_of(const Bodies& bodies, const Collider& a, const Collider& b);

// Half of the least extent of the smaller one; 0 if neither has one.
double smaller_size(const Collider& a, const Collider& b);

}  // namespace vp
