// Pairs of colliders that may collide within the rest of the step.
#include <algorithm>

#include "world/impl.h"

namespace vp {
namespace {

bool pushable_or_sensed(const Body& a, const Body& b, const Collider& ca, const Collider& cb) {
  return a.motion == Motion::dynamic || b.motion == Motion::dynamic || ca.sensor || cb.sensor;
}

// The colliders of a continuous body are swept, except sensors that are not spheres: these are
// tested at their pose at the start of a step.
bool is_swept(const Body& body, const Collider& c) {
  return body.continuous && (!c.sensor || c.geometry.kind == collide::Kind::sphere);
}

}  // namespace

void World::Impl::refresh_bounds(double h) {
  if (!impacts.swept_body_pairs.dirty()) {
    for (const std::uint32_t i : lists.of_impacts(bodies)) refresh_bounds_of(i, h);
    return;
  }
  for (std::uint32_t i = 0; i < bodies.size(); ++i) {
    if (!bodies[i].remote) refresh_bounds_of(i, h);
  }
}
void World::Impl::refresh_bounds_of(std::uint32_t i, double h) {
  const Body& body = bodies[i];
  if (!body.alive || body.first_collider == kNone) {
    impacts.bounds[i] = {};
  } else if (body.unbounded) {
    impacts.bounds[i] = bounds_at_pose(bodies[i], colliders);
  } else {
    impacts.bounds[i] = grown(bounds_at_pose(bodies[i], colliders),
                              desc.contact_slop + travel_of_bounds(body, impacts.motions[i], h));
  }
}

double World::Impl::discrete_margin(const ColliderPair& pair, double h) const {
  const std::uint32_t a = colliders[pair.a].body, b = colliders[pair.b].body;
  return desc.contact_slop + travel(bodies[a], impacts.motions[a], h) +
         travel(bodies[b], impacts.motions[b], h);
}

// Pairs without a swept collider.
void World::Impl::find_discrete_pairs(double h) {
  impacts.discrete_pairs.clear();
  for (const collide::IndexPair& pair : impacts.discrete_body_pairs.find(body_motions())) {
    const Body &a = bodies[pair.a], &b = bodies[pair.b];
    const bool continuous = a.continuous || b.continuous;
    if (!continuous && !a.is_link && !b.is_link) continue;  // belongs to the sub-stepped solver
    const bool sensors_only = in_sub_steps(articulations, a, b);
    const bool carries_sensor = (a.continuous && a.has_sensor) || (b.continuous && b.has_sensor);
    if ((continuous && !carries_sensor) || !may_overlap(a, b)) continue;
    if (disables_collision(bodies, joints, pair.a, pair.b)) continue;
    wake(pair.a);
    wake(pair.b);
    pose_colliders(bodies[pair.a], colliders);
    pose_colliders(bodies[pair.b], colliders);
    const double margin = desc.contact_slop + travel(a, impacts.motions[pair.a], h) +
                          travel(b, impacts.motions[pair.b], h);
    for (std::uint32_t i = a.first_collider; i != kNone; i = colliders[i].next) {
      const Collider& ca = colliders[i];
      const collide::Bounds near = grown(ca.bounds, margin);
      if (!overlap(near, impacts.bounds[pair.b])) continue;
      for (std::uint32_t j = b.first_collider; j != kNone; j = colliders[j].next) {
        const Collider& cb = colliders[j];
        if (!overlap(near, cb.bounds) || !should_collide(ca, cb)) continue;
        if (continuous && (is_swept(a, ca) || is_swept(b, cb))) continue;
        if (sensors_only && !ca.sensor && !cb.sensor) continue;
        if (pushable_or_sensed(a, b, ca, cb))
          impacts.discrete_pairs.push_back(make_pair(colliders, i, j));
      }
    }
  }
  std::sort(impacts.discrete_pairs.begin(), impacts.discrete_pairs.end(),
            [](const ColliderPair& p, const ColliderPair& q) { return p.key < q.key; });
  counters.pairs += static_cast<std::uint32_t>(impacts.discrete_pairs.size());
}

collide::SweepQuery ImpactTimes::sweep_query(const SweptPair& p, double h) const {
  const Collider& sphere = colliders[p.swept_is_a ? p.pair.a : p.pair.b];
  const Collider& other = colliders[p.swept_is_a ? p.pair.b : p.pair.a];
  return {sphere.T.position(),
          sphere.geometry.radius,
          motions[sphere.body],
          &other.geometry,
          other.T,
          motions[other.body],
          h,
          tolerance()};
}

// A sphere has closed forms, which are faster than the general search.
double ImpactTimes::until(const SweptPair& p, double target, double h) const {
  const Collider &c = colliders[p.swept_is_a ? p.pair.a : p.pair.b],
                 &other = colliders[p.swept_is_a ? p.pair.b : p.pair.a];
  if (c.geometry.kind == collide::Kind::sphere) return time_of_impact(sweep_query(p, h), target);
  const collide::ImpactQuery query{{&c.geometry, c.T, motions[c.body]},
                                   {&other.geometry, other.T, motions[other.body]},
                                   h,
                                   tolerance()};
  // Parts of a surface that are close but make no contact (inactive edges, back faces) must not
  // stop the body: the solver has no constraint that would separate it from them.
  const auto near =
      is_surface(other.geometry) ? collide::NearParts::passed : collide::NearParts::met;
  collide::PartsImpact found{};
  return first_impact(query, target, parts, found, near) ? found.time : -1.0;
}

double ImpactTimes::separation(const Collider& moving, const Collider& other, double margin,
                               collide::ManifoldScratch& scratch,
                               std::vector<collide::SubManifold>& manifolds) const {
  if (!has_parts(moving.geometry, other.geometry)) {
    if (moving.geometry.kind != collide::Kind::sphere) {
      collide::PairCache fresh;
      return closest_points(moving.geometry, moving.T, other.geometry, other.T, fresh).distance;
    }
    const Vec3 local = inverse_times(other.T, moving.T.position());
    return signed_distance(other.geometry, local).distance - moving.geometry.radius;
  }
  double min_separation = margin;
  manifolds.clear();
  collide::PairCache cache;
  find_manifolds(moving.geometry, moving.T, other.geometry, other.T, slop, cache, {}, scratch,
                 manifolds);
  for (const collide::SubManifold& found : manifolds) {
    for (int k = 0; k < found.manifold.count; ++k) {
      min_separation = std::min(min_separation, found.manifold.points[k].separation);
    }
  }
  return min_separation;
}

namespace {

// The distance from x to the farthest point that rotates with the collider, or to a sphere's
// centre.
double radius_from(const Vec3& x, const Collider& c) {
  if (c.geometry.kind == collide::Kind::sphere) return norm(c.T.position() - x);
  if (c.geometry.kind != collide::Kind::compound) {
    return norm(c.T * core_centre(c.geometry) - x) + core_extent(c.geometry);
  }
  const collide::Bounds& b = c.bounds;
  return norm(0.5 * (b.lower + b.upper) - x) + 0.5 * norm(b.upper - b.lower);
}

}  // namespace

// Adds the pairs of a continuous body's colliders with those of another body that can collide
// within h.
void World::Impl::add_swept_pairs(std::uint32_t index, std::uint32_t other, double h) {
  wake(other);
  const Body &a = bodies[index], &b = bodies[other];
  const collide::Motion &ma = impacts.motions[index], &mb = impacts.motions[other];
  const ImpactTimes times = impact_times();
  pose_colliders(bodies[index], colliders);
  const double speed = norm(ma.v - mb.v);
  const double wa = norm(ma.w), wb = norm(mb.w);
  for (std::uint32_t i = a.first_collider; i != kNone; i = colliders[i].next) {
    const Collider& ca = colliders[i];
    if (!is_swept(a, ca)) continue;
    const double own = speed + wa * radius_from(ma.x, ca);
    const double far = radius_from(mb.x, ca) + own * h;
    const double margin = desc.contact_slop + (own + wb * far) * h;
    const collide::Bounds near = grown(ca.bounds, margin), from_b = moved(near, -b.T.position());
    for (std::uint32_t j = b.first_collider; j != kNone; j = colliders[j].next) {
      Collider& cb = colliders[j];
      if (b.is_link && !empty(cb.around_line) && !overlap(from_b, cb.around_line)) continue;
      pose_collider(b, cb);
      if (!overlap(near, cb.bounds) || !should_collide(ca, cb)) continue;
      if (b.continuous && other < index && is_swept(b, cb)) continue;
      const double separation =
          times.separation(ca, cb, margin, shapes.manifold_scratch, shapes.manifolds);
      if (separation > margin) continue;
      const ColliderPair pair = make_pair(colliders, i, j);
      impacts.swept_pairs.push_back({pair, pair.a == i, ca.sensor || cb.sensor, separation});
    }
  }
}

// Two continuous bodies are paired once, in the order of their slots. Exception: a sensor that is
// not swept is paired with the swept colliders of the other body.
void World::Impl::add_swept_pairs_of(const collide::IndexPair& p, double h) {
  if (disables_collision(bodies, joints, p.a, p.b)) return;
  const bool a = impacts.swept_body_pairs.sweeps(p.a), b = impacts.swept_body_pairs.sweeps(p.b);
  if (a) add_swept_pairs(p.a, p.b, h);
  if (b && (!a || bodies[p.a].has_sensor)) add_swept_pairs(p.b, p.a, h);
}

// Finds the swept pairs that touch. Precondition: all bodies are at the same time.
void World::Impl::find_touching_pairs(double h) {
  impacts.swept_pairs.clear();
  const auto bounds_of_body = [this](std::uint32_t i) -> const collide::Bounds& {
    return bounds_at_pose(bodies[i], colliders);
  };
  for (const collide::IndexPair& p : impacts.swept_body_pairs.find(
           body_motions(), lists.of_impacts(bodies), desc.contact_slop, h)) {
    if (empty(impacts.bounds[p.a]) || empty(impacts.bounds[p.b])) continue;
    if (!overlap(grown(bounds_of_body(p.a), desc.contact_slop), bounds_of_body(p.b))) continue;
    add_swept_pairs_of(p, 0.0);
  }
  sort_swept_pairs();
}

// Finds the swept pairs that can collide within h. Precondition: all bodies are at the same time.
void World::Impl::find_swept_pairs(double h) {
  impacts.swept_pairs.clear();
  for (const collide::IndexPair& p : impacts.swept_body_pairs.find(
           body_motions(), lists.of_impacts(bodies), desc.contact_slop, h)) {
    if (overlap(impacts.bounds[p.a], impacts.bounds[p.b])) add_swept_pairs_of(p, h);
  }
  sort_swept_pairs();
  counters.pairs = std::max(
      counters.pairs,
      static_cast<std::uint32_t>(impacts.discrete_pairs.size() + impacts.swept_pairs.size()));
}

void World::Impl::sort_swept_pairs() {
  std::sort(impacts.swept_pairs.begin(), impacts.swept_pairs.end(),
            [](const SweptPair& p, const SweptPair& q) { return p.pair.key < q.pair.key; });
}

}  // namespace vp
