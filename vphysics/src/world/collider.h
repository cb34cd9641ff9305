// A collider as the world stores it, and pairs of colliders.
#pragma once

#include <cstdint>

#include "collide/bounds.h"
#include "collide/geometry.h"
#include "vphysics/world.h"
#include "world/body.h"
#include "world/slots.h"

namespace vp {

inline constexpr double kUnboundedRadius = 1e30;  // the bounding radius of a half-space [m]

// Data that every narrow-phase test of its contacts reads come first.
struct alignas(64) Collider {
  std::uint32_t body = kNone;
  std::uint32_t proxy = kNone;  // in the broad phase
  bool alive = false;
  bool sensor = false;
  bool stray = false;          // outside its proxy's bounds: find_strays()
  std::uint32_t next = kNone;  // collider of the same body
  // Half of its smallest extent [m], for a compound that of its smallest part. 0 for half-spaces,
  // meshes and height fields.
  double size = 0.0;
  // Bounding sphere, body frame; kUnboundedRadius for a half-space.
  double radius = kUnboundedRadius;
  Vec3 centre;
  std::uint32_t generation = 0;
  std::uint32_t serial = 0;  // order of creation

  collide::Geometry geometry;
  // T and bounds are valid for this pose_number of the body; the step refreshes them (Body::posed).
  std::uint64_t posed_for = 0;
  SE3 T;
  Material material;
  Vec3 surface_velocity;  // shape's frame
  collide::Bounds bounds;
  SE3 T_body_shape;
  CollisionFilter filter;
  double density = 0.0;  // [kg/m^3]
  // As Body::around_line.
  collide::Bounds around_line;
  std::uint64_t user_data = 0;
  Shape shape = HalfSpace{};  // owns the data that geometry points to
};

using Colliders = Slots<Collider, ColliderId>;

// Computes the poses and bounds of a body's colliders at its pose.
void pose_collider(const Body& body, Collider& collider);
void pose_colliders(Body& body, Colliders& colliders);
// The same where other workers may do so too: one of them does, and all see it when the loop ends.
void pose_colliders_once(Body& body, Colliders& colliders);
const collide::Bounds& bounds_at_pose(Body& body, Colliders& colliders);
// Adds a collider to the body's summary of its colliders. line: the line that a link only slides
// along and rotates about; otherwise zero.
void note_collider(Body& body, Collider& collider, const Vec3& line);
// Sum over a body's solid colliders, except one.
Inertia inertia_of_colliders(const Body& body, const Colliders& colliders,
                             std::uint32_t without = kNone);

// a and b in order of creation.
struct ColliderPair {
  std::uint64_t key;
  std::uint32_t a, b;
};

// Orders a pair by creation.
ColliderPair make_pair(const Colliders& colliders, std::uint32_t i, std::uint32_t j);
bool should_collide(const Collider& a, const Collider& b);

// The bounding sphere of the smaller of two colliders: where they touch, if they do. World frame.
// All bounds of the approach of two colliders use it: relative velocity at its centre, and relative
// rotation times its radius.
struct Vicinity {
  Vec3 centre;
  double radius;  // 0 if the smaller is a sphere: contact is along the line through its centre
  bool is_of_b;   // the smaller is b
};

Vicinity vicinity_of(const Bodies& bodies, const Collider& a, const Collider& b);

// Half of the smallest extent of the smaller one; 0 if neither has one.
double smaller_size(const Collider& a, const Collider& b);

// How far the two may slide on each other before their contact is computed again [m].
inline double slide_limit(const Collider& a, const Collider& b) {
  return 0.01 * smaller_size(a, b);
}

}  // namespace vp
