#include "world/collider.h"

#include <algorithm>
#include <cmath>

#include "collide/compound_data.h"
#include "collide/support.h"

namespace vp {
namespace {

// Bounds of a box for all its rotations about its z axis, whose direction in the outer frame is the
// unit vector `line`: those of a cylinder. Empty if line is zero.
collide::Bounds bounds_around(const Vec3& line, const collide::Bounds& box) {
  if (line == Vec3{}) return {};
  const double x = std::max(-box.lower.x, box.upper.x), y = std::max(-box.lower.y, box.upper.y);
  const double radius = std::sqrt(x * x + y * y);
  const double half = 0.5 * (box.upper.z - box.lower.z), mid = 0.5 * (box.upper.z + box.lower.z);
  const auto extent = [&](double u) {
    return std::fabs(u) * half + radius * std::sqrt(std::max(0.0, 1.0 - u * u));
  };
  const Vec3 extents{extent(line.x), extent(line.y), extent(line.z)};
  return collide::grown({mid * line - extents, mid * line + extents}, 1e-12 * radius);
}

}  // namespace

const collide::Bounds& bounds_at_pose(Body& body, Colliders& colliders) {
  if (body.bounded) return body.bounds;
  body.bounded = true;
  if (!collide::empty(body.around_line)) {
    return body.bounds = moved(body.around_line, body.T.position());
  }
  body.bounds =
      collide::empty(body.local) ? collide::Bounds{} : collide::transformed(body.T, body.local);
  if (body.unbounded) {
    // The bounds of a body with a plane enclose those of all its colliders, planes included.
    pose_colliders(body, colliders);
    for (std::uint32_t c = body.first_collider; c != kNone; c = colliders[c].next) {
      body.bounds = merged(body.bounds, colliders[c].bounds);
    }
  }
  return body.bounds;
}

void pose_colliders(Body& body, Colliders& colliders) {
  if (body.posed) return;
  for (std::uint32_t c = body.first_collider; c != kNone; c = colliders[c].next) {
    pose_collider(body, colliders[c]);
  }
  __atomic_store_n(&body.posed, true, __ATOMIC_RELEASE);
}
void pose_colliders_once(Body& body, Colliders& colliders) {
  if (__atomic_load_n(&body.posed, __ATOMIC_ACQUIRE)) return;
  if (__atomic_exchange_n(&body.is_being_posed, true, __ATOMIC_ACQUIRE)) return;
  pose_colliders(body, colliders);
  __atomic_store_n(&body.is_being_posed, false, __ATOMIC_RELEASE);
}
void pose_collider(const Body& body, Collider& collider) {
  if (collider.posed_for == body.pose_number) return;
  collider.posed_for = body.pose_number;
  collider.T = body.T * collider.T_body_shape;
  collider.bounds = bounds_of(collider.geometry, collider.T);
}

void note_collider(Body& body, Collider& c, const Vec3& line) {
  body.categories |= c.filter.category;
  body.masks |= c.filter.mask;
  body.has_sensor |= c.sensor;
  if (std::holds_alternative<HalfSpace>(c.shape)) {
    body.unbounded = true;
    return;
  }
  const collide::Bounds local = bounds_of(c.geometry, c.T_body_shape);
  c.centre = 0.5 * (local.lower + local.upper);
  c.radius = 0.5 * norm(local.upper - local.lower);
  const double around_core = core_radius(c.geometry) + core_extent(c.geometry);
  if (is_convex_body(c.geometry) && around_core <= c.radius) {
    c.centre = c.T_body_shape * core_centre(c.geometry);
    c.radius = around_core;
  }
  body.local = merged(body.local, local);
  c.size = min_half_extent(c.geometry);
  body.bounding_radius = bounding_radius_of(body);
  if (body.is_link) {
    c.around_line = bounds_around(line, local);
    body.around_line = bounds_around(line, body.local);
  }
  body.min_size = std::min(body.min_size, c.size);
}

Inertia inertia_of_colliders(const Body& body, const Colliders& colliders, std::uint32_t without) {
  Inertia sum;
  for (std::uint32_t c = body.first_collider; c != kNone; c = colliders[c].next) {
    const Collider& collider = colliders[c];
    if (collider.sensor || c == without) continue;
    sum = sum + solid_inertia(collider.shape, collider.density).InvXform(collider.T_body_shape);
  }
  return sum;
}

ColliderPair make_pair(const Colliders& colliders, std::uint32_t i, std::uint32_t j) {
  if (colliders[i].serial > colliders[j].serial) std::swap(i, j);
  return {(std::uint64_t{colliders[i].serial} << 32) | colliders[j].serial, i, j};
}

bool should_collide(const Collider& a, const Collider& b) {
  return (a.filter.category & b.filter.mask) && (b.filter.category & a.filter.mask) &&
         !(a.sensor && b.sensor);
}

Vicinity vicinity_of(const Bodies& bodies, const Collider& a, const Collider& b) {
  const Collider& smaller = a.radius <= b.radius ? a : b;
  const bool turns =
      smaller.geometry.kind != collide::Kind::sphere && smaller.radius < kUnboundedRadius;
  return {bodies[smaller.body].T * smaller.centre, turns ? smaller.radius : 0.0, &smaller == &b};
}

double smaller_size(const Collider& a, const Collider& b) {
  if (a.size == 0.0) return b.size;
  return b.size == 0.0 ? a.size : std::min(a.size, b.size);
}

}  // namespace vp
