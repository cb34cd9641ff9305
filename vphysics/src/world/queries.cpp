// Ray casts, shape casts, overlap tests and nearest colliders, through the trees of the broad
// phase.
//
// Between steps a collider may have left the enlarged AABB of its proxy. Only a step may change
// that AABB, since it is state. Queries test such strays one by one. There are few, since a step
// gives moving bodies AABBs that are valid for the next step.
//
// The result for each collider is exact and depends on nothing else. The trees only exclude
// colliders that cannot be part of the result. So the result does not depend on the shape of the
// trees, for instance after restore().
#include <algorithm>
#include <cmath>

#include "collide/ray.h"
#include "world/impl.h"
#include "world/invalid.h"
#include "world/validate.h"

namespace vp {
namespace {

// A cast shape touches at this distance [m, and fraction of the sizes].
constexpr double kTouch = 1e-9, kTouchFraction = 1e-12;
constexpr double kFullRevolution = 6.2832;

std::optional<Error> invalid(const char* call, const char* why) {
  return Error{Errc::invalid_argument, std::string(call) + ": " + why};
}

std::optional<Error> problem_with_ray(const char* call, const Vec3& origin, const Vec3& direction,
                                      double distance) {
  if (!in_range(origin)) return invalid(call, "the origin must be finite and within 1e9 m");
  if (!in_range(direction) || !(norm(direction) > 0.0))
    return invalid(call, "the direction must be finite, within 1e9 and not zero");
  if (!in_range(distance) || distance < 0.0)
    return invalid(call, "max_distance must be zero or more and at most 1e9 m");
  return std::nullopt;
}

std::optional<Error> problem_with_query(const char* call, const Shape& shape, const SE3& T) {
  if (auto problem = problem_with_shape(shape)) return invalid(call, problem->c_str());
  const bool is_endless = std::holds_alternative<HalfSpace>(shape);
  if (is_endless || std::holds_alternative<TriangleMesh>(shape) ||
      std::holds_alternative<HeightField>(shape)) {
    return Error{
        Errc::unsupported,
        std::string(call) + ": the shape must be convex and bounded, or a compound of such shapes"};
  }
  if (!is_pose(T)) return invalid(call, "T_world_shape must be a finite rotation and position");
  return std::nullopt;
}

std::optional<Error> problem_with_cast(const char* call, const Shape& shape, const SE3& T,
                                       const CastMotion& motion) {
  if (auto problem = problem_with_query(call, shape, T)) return problem;
  if (!in_range(motion.translation))
    return invalid(call, "the translation must be finite and within 1e9 m");
  if (!in_range(motion.rotation) || norm(motion.rotation) > kFullRevolution) {
    return invalid(call,
                   "the turn must be finite and no more than one; cast again from where the first "
                   "one ends");
  }
  return std::nullopt;
}

SE3 proper(const SE3& T) {
  return {orthonormalized(T.rotation()), T.position()};
}

collide::MovingShape moving(const collide::Geometry& shape, const SE3& T, const CastMotion& m) {
  return {&shape, T, {T.position(), m.translation, m.rotation}};
}

// The AABB sweep that contains the shape's motion over the time 1.
collide::Sweep sweep_of(const collide::MovingShape& m) {
  const collide::Bounds start = bounds_of(*m.shape, m.T);
  const Vec3 far{std::max(start.upper.x - m.motion.x.x, m.motion.x.x - start.lower.x),
                 std::max(start.upper.y - m.motion.x.y, m.motion.x.y - start.lower.y),
                 std::max(start.upper.z - m.motion.x.z, m.motion.x.z - start.lower.z)};
  const double grow = std::min(norm(m.motion.w), 2.0) * norm(far);
  return {grown(start, kTouch + grow), m.motion.v};
}

}  // namespace

// One query. The colliders are posed and the strays are known.
struct Query {
  const Bodies& bodies;
  const Colliders& colliders;
  const collide::PairFinder& finder;
  QueryScratch& scratch;
  collide::PartsScratch& parts;
  const QueryFilter& filter;

  // Calls collide(collider) for each collider that the sweep may hit; it returns the fraction at
  // which to stop.
  template <class F>
  void for_swept(const collide::Sweep& sweep, const F& collide) {
    double limit = 1.0;
    const collide::BoxSweep box_sweep(sweep);
    for (const std::uint32_t i : scratch.strays) {
      float entry = 0.0f;
      const Collider& c = colliders[i];
      if (box_sweep.overlaps(rounded_outward(c.bounds), limit, entry) && is_asked_for(c)) {
        limit = collide(c);
      }
    }
    finder.cast(sweep, limit, scratch.cast, [&](std::uint32_t proxy, float) {
      const Collider& c = colliders[finder.user(proxy)];
      if (!c.stray && is_asked_for(c)) limit = collide(c);
      return limit;
    });
  }

  // Calls hit(RayHit) for each collider that the ray hits; it returns the distance at which to
  // stop.
  template <class F>
  void for_ray_hits(const Vec3& origin, const Vec3& unit, double limit, const F& hit) {
    const double full_length = limit;
    for_swept({{origin, origin}, limit * unit}, [&](const Collider& c) {
      const collide::Ray ray{inverse_times(c.T, origin), c.T.unrotate(unit)};
      collide::RayEntry entry{};
      if (cast_ray(c.geometry, ray, full_length, parts.cast, entry)) {
        limit = hit(RayHit{hit_of(c, entry.part), entry.distance, origin + entry.distance * unit,
                           c.T.rotate(entry.normal)});
      }
      return full_length > 0.0 ? limit / full_length : 1.0;
    });
  }

  // Calls hit(ShapeHit) for each collider that the cast hits; it returns the fraction at which to
  // stop.
  template <class F>
  void for_cast_hits(const collide::MovingShape& shape, const F& hit) {
    double limit = 1.0;
    for_swept(sweep_of(shape), [&](const Collider& c) {
      const double sizes =
          core_extent(*shape.shape) + (is_convex_body(c.geometry) ? core_extent(c.geometry) : 0.0);
      const collide::ImpactQuery query{shape,
                                       {&c.geometry, c.T, {c.T.position(), {}, {}}},
                                       1.0,
                                       kTouch + kTouchFraction * sizes};
      collide::PartsImpact impact{};
      if (first_impact(query, 0.0, parts, impact)) {
        limit = hit(ShapeHit{hit_of(c, impact.part_b), impact.time, impact.points.distance,
                             impact.points.on_b, -impact.points.normal});
      }
      return limit;
    });
  }

  std::optional<NearestHit> nearest(const collide::Geometry& shape, const SE3& T, double limit) {
    std::optional<NearestHit> best;
    const auto consider = [&](const Collider& c) {
      collide::NearestParts found;
      if (!is_asked_for(c) || !nearest_parts(shape, T, c.geometry, c.T, limit, parts, found)) {
        return;
      }
      const collide::ClosestPoints& p = found.points;
      const NearestHit hit{hit_of(c, found.part_b), p.distance, p.on_a, p.on_b, -p.normal};
      if (best && !comes_before(hit.distance, hit, best->distance, *best)) return;
      best = hit;
      limit = std::min(limit, std::max(0.0, hit.distance));
    };
    const collide::Bounds box = bounds_of(shape, T);
    for (const std::uint32_t i : scratch.strays) {
      const collide::FloatBounds around = rounded_outward(colliders[i].bounds);
      if (static_cast<double>(distance_between(box, around, {1.0, 1.0, 1.0})) <= limit) {
        consider(colliders[i]);
      }
    }
    finder.nearest(box, limit, scratch.cast, [&](std::uint32_t proxy, float) {
      const Collider& c = colliders[finder.user(proxy)];
      if (!c.stray) consider(c);
      return limit;
    });
    return best;
  }

  QueryHit hit_of(const Collider& c, std::uint32_t part) const {
    const auto index = colliders.index_of(c);
    return {colliders.id(index), bodies.id(c.body), c.user_data, part};
  }

  // Whether a hit at x comes before another at y. Ties: the older collider first.
  bool comes_before(double x, const QueryHit& hit, double y, const QueryHit& other) const {
    return x < y || (x == y && colliders[hit.collider.index - 1].serial <
                                   colliders[other.collider.index - 1].serial);
  }

  bool is_asked_for(const Collider& c) const {
    const bool met = (c.filter.category & filter.collision.mask) != 0 &&
                     (filter.collision.category & c.filter.mask) != 0;
    if (!met || (c.sensor && !filter.sensors)) return false;
    const BodyId body = bodies.id(c.body);
    if (std::find(filter.ignored.begin(), filter.ignored.end(), body) != filter.ignored.end()) {
      return false;
    }
    const auto index = colliders.index_of(c);
    return !filter.accepts || filter.accepts(colliders.id(index), body, c.user_data);
  }
};

void World::Impl::find_strays() {
  if (ready_for_queries) return;
  update_all_remote();
  ready_for_queries = true;
  queries.strays.clear();
  queries.strays.reserve(colliders.size());
  queries.cast.reserve(2 * colliders.size() + 16);  // items and nodes
  for (std::uint32_t b = 0; b < bodies.size(); ++b) {
    if (!bodies[b].alive || bodies[b].first_collider == kNone) continue;
    pose_colliders(bodies[b], colliders);
    for (std::uint32_t i = bodies[b].first_collider; i != kNone; i = colliders[i].next) {
      Collider& c = colliders[i];
      c.stray = !holds(finder.enlarged_bounds(c.proxy), c.bounds);
      if (c.stray) queries.strays.push_back(i);
    }
  }
  finder.refresh();
}

Query World::Impl::query(const QueryFilter& filter) {
  find_strays();
  return {bodies, colliders, finder, queries, shapes.parts_scratch, filter};
}

// --- ray casts -----------------------------------------------------------------------------------

Expected<std::optional<RayHit>> World::ray_cast(const Vec3& origin, const Vec3& direction,
                                                double max_distance,
                                                const QueryFilter& filter) const {
  if (auto problem = problem_with_ray("ray_cast", origin, direction, max_distance)) {
    return tl::make_unexpected(*problem);
  }
  std::optional<RayHit> first;
  Query query = impl_->query(filter);
  query.for_ray_hits(origin, (1.0 / norm(direction)) * direction, max_distance,
                     [&](const RayHit& hit) {
                       if (!first || query.comes_before(hit.distance, hit, first->distance, *first))
                         first = hit;
                       return first->distance;
                     });
  return first;
}

Expected<void> World::ray_cast_all(const Vec3& origin, const Vec3& direction, double max_distance,
                                   std::vector<RayHit>& hits, const QueryFilter& filter) const {
  if (auto problem = problem_with_ray("ray_cast_all", origin, direction, max_distance)) {
    return tl::make_unexpected(*problem);
  }
  const auto begin = static_cast<std::ptrdiff_t>(hits.size());
  Query query = impl_->query(filter);
  query.for_ray_hits(origin, (1.0 / norm(direction)) * direction, max_distance,
                     [&](const RayHit& hit) {
                       hits.push_back(hit);
                       return max_distance;
                     });
  std::sort(hits.begin() + begin, hits.end(), [&](const RayHit& a, const RayHit& b) {
    return query.comes_before(a.distance, a, b.distance, b);
  });
  return {};
}

// --- shape casts ---------------------------------------------------------------------------------

Expected<std::optional<ShapeHit>> World::shape_cast(const Shape& shape, const SE3& T,
                                                    const CastMotion& motion,
                                                    const QueryFilter& filter) const {
  if (auto problem = problem_with_cast("shape_cast", shape, T, motion)) {
    return tl::make_unexpected(*problem);
  }
  std::optional<ShapeHit> first;
  const collide::Geometry geometry = collide::make_geometry(shape);
  Query query = impl_->query(filter);
  query.for_cast_hits(moving(geometry, proper(T), motion), [&](const ShapeHit& hit) {
    if (!first || query.comes_before(hit.fraction, hit, first->fraction, *first)) first = hit;
    return first->fraction;
  });
  return first;
}

Expected<void> World::shape_cast_all(const Shape& shape, const SE3& T, const CastMotion& motion,
                                     std::vector<ShapeHit>& hits, const QueryFilter& filter) const {
  if (auto problem = problem_with_cast("shape_cast_all", shape, T, motion)) {
    return tl::make_unexpected(*problem);
  }
  const auto begin = static_cast<std::ptrdiff_t>(hits.size());
  const collide::Geometry geometry = collide::make_geometry(shape);
  Query query = impl_->query(filter);
  query.for_cast_hits(moving(geometry, proper(T), motion), [&](const ShapeHit& hit) {
    hits.push_back(hit);
    return 1.0;
  });
  std::sort(hits.begin() + begin, hits.end(), [&](const ShapeHit& a, const ShapeHit& b) {
    return query.comes_before(a.fraction, a, b.fraction, b);
  });
  return {};
}

// --- overlaps and nearest colliders --------------------------------------------------------------

Expected<void> World::overlapping(const Shape& shape, const SE3& T_world_shape,
                                  std::vector<ColliderId>& found, const QueryFilter& filter) const {
  if (auto problem = problem_with_query("overlapping", shape, T_world_shape)) {
    return tl::make_unexpected(*problem);
  }
  const auto begin = static_cast<std::ptrdiff_t>(found.size());
  const collide::Geometry geometry = collide::make_geometry(shape);
  const SE3 T = proper(T_world_shape);
  Query query = impl_->query(filter);
  query.for_swept({bounds_of(geometry, T), {}}, [&](const Collider& c) {
    if (parts_touch(geometry, T, c.geometry, c.T, query.parts)) {
      found.push_back(query.hit_of(c, 0).collider);
    }
    return 1.0;
  });
  std::sort(found.begin() + begin, found.end(), [&](ColliderId a, ColliderId b) {
    return impl_->colliders[a.index - 1].serial < impl_->colliders[b.index - 1].serial;
  });
  return {};
}

Expected<std::optional<NearestHit>> World::nearest(const Shape& shape, const SE3& T,
                                                   double max_distance,
                                                   const QueryFilter& filter) const {
  if (auto problem = problem_with_query("nearest", shape, T)) {
    return tl::make_unexpected(*problem);
  }
  if (!in_range(max_distance) || max_distance < 0.0) {
    return invalid("nearest: max_distance must be zero or more and at most 1e9 m");
  }
  return impl_->query(filter).nearest(collide::make_geometry(shape), proper(T), max_distance);
}

Expected<std::optional<NearestHit>> World::nearest(const Vec3& point, double max_distance,
                                                   const QueryFilter& filter) const {
  if (!in_range(point)) return invalid("nearest: the point must be finite and within 1e9 m");
  if (!in_range(max_distance) || max_distance < 0.0) {
    return invalid("nearest: max_distance must be zero or more and at most 1e9 m");
  }
  return impl_->query(filter).nearest({}, SE3(point), max_distance);  // a sphere of radius zero
}

}  // namespace vp
