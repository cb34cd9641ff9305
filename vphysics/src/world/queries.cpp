// Rays, sphere casts and overlaps, against every collider in turn.
#include <algorithm>
#include <cmath>

#include "world/impl.h"
#include "world/validate.h"

namespace vp {
namespace {

bool passes(const Collider& c, const CollisionFilter& filter) {
  return c.alive && !c.sensor && (c.filter.category & filter.mask) &&
         (filter.category & c.filter.mask);
}

}  // namespace

std::optional<RayHit> World::ray_cast(const Vec3& origin, const Vec3& direction,
                                      double max_distance, CollisionFilter filter) const {
  return sphere_cast(origin, 0.0, direction, max_distance, filter);
}

// A sphere that moves at unit speed: its time of impact is its travel.
std::optional<RayHit> World::sphere_cast(const Vec3& origin, double radius, const Vec3& direction,
                                         double max_distance, CollisionFilter filter) const {
  const double length = norm(direction);
  if (!in_range(origin) || !in_range(direction) || !(length > 0.0) || !in_range(radius) ||
      radius < 0.0 || !in_range(max_distance) || max_distance < 0.0) {
    return std::nullopt;
  }
  const Vec3 unit = (1.0 / length) * direction;
  std::optional<RayHit> nearest;
  std::uint32_t nearest_serial = 0;
  for (std::uint32_t i = 0; i < impl_->colliders.size(); ++i) {
    const Collider& c = impl_->colliders[i];
    if (!passes(c, filter)) continue;
    const Body& body = impl_->bodies[c.body];
    constexpr double kTolerance = 1e-9;
    collide::SweepQuery query{origin,
                              radius,
                              {origin, unit, {}},
                              &c.geometry,
                              body.T * c.T_body_shape,
                              {body.T.position(), {}, {}},
                              max_distance,
                              kTolerance};
    const double t = separation_at(query, 0.0) <= kTolerance ? 0.0 : time_of_impact(query, 0.0);
    if (t < 0.0) continue;
    const bool nearer =
        !nearest || t < nearest->distance || (t == nearest->distance && c.serial < nearest_serial);
    if (!nearer) continue;
    const Vec3 centre = origin + t * unit;
    const collide::SignedDistance d =
        signed_distance(c.geometry, inverse_times(query.T_shape, centre));
    const Vec3 normal = query.T_shape.rotate(d.normal);
    nearest = RayHit{collider_id(impl_->colliders, i),
                     body_id(impl_->bodies, c.body),
                     c.user_data,
                     t,
                     centre - d.distance * normal,
                     normal};
    nearest_serial = c.serial;
  }
  return nearest;
}

void World::overlap_sphere(const Vec3& centre, double radius, std::vector<ColliderId>& found,
                           CollisionFilter filter) const {
  if (!in_range(centre) || !in_range(radius) || radius < 0.0) return;
  const std::size_t first = found.size();
  for (std::uint32_t i = 0; i < impl_->colliders.size(); ++i) {
    const Collider& c = impl_->colliders[i];
    if (!passes(c, filter)) continue;
    const SE3 T = impl_->bodies[c.body].T * c.T_body_shape;
    if (signed_distance(c.geometry, inverse_times(T, centre)).distance <= radius) {
      found.push_back(collider_id(impl_->colliders, i));
    }
  }
  std::sort(found.begin() + static_cast<std::ptrdiff_t>(first), found.end(),
            [&](ColliderId a, ColliderId b) {
              return impl_->colliders[a.index - 1].serial < impl_->colliders[b.index - 1].serial;
            });
}

}  // namespace vp
