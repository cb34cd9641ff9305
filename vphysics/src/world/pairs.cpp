// Pairs of colliders that may collide within the rest of the step.
#include <algorithm>

#include "world/impact_stage.h"

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

void ImpactStage::refresh_bounds(double h) {
  if (!swept_body_pairs_.dirty()) {
    for (const std::uint32_t i : moving_bodies()) refresh_bounds_of(i, h);
    return;
  }
  for (std::uint32_t i = 0; i < s_.bodies.size(); ++i) {
    if (!s_.bodies[i].remote) refresh_bounds_of(i, h);
  }
}
void ImpactStage::refresh_bounds_of(std::uint32_t i, double h) {
  const Body& body = s_.bodies[i];
  if (!body.alive || body.first_collider == kNone) {
    bounds_[i] = {};
  } else if (body.unbounded) {
    bounds_[i] = bounds_at_pose(s_.bodies[i], s_.colliders);
  } else {
    bounds_[i] = grown(bounds_at_pose(s_.bodies[i], s_.colliders),
                       s_.desc.contact_slop + travel_of_bounds(body, motions_[i], h));
  }
}

double ImpactStage::discrete_margin(const ColliderPair& pair, double h) const {
  const std::uint32_t a = s_.colliders[pair.a].body, b = s_.colliders[pair.b].body;
  return s_.desc.contact_slop + travel(s_.bodies[a], motions_[a], h) +
         travel(s_.bodies[b], motions_[b], h);
}

// Pairs without a swept collider.
void ImpactStage::find_discrete_pairs(double h) {
  discrete_pairs_.clear();
  for (const collide::IndexPair& pair : discrete_body_pairs_.find(body_motions())) {
    const Body &a = s_.bodies[pair.a], &b = s_.bodies[pair.b];
    const bool continuous = a.continuous || b.continuous;
    if (!continuous && !a.is_link && !b.is_link) continue;  // belongs to the sub-stepped solver
    const bool sensors_only = in_sub_steps(s_.articulations, a, b);
    const bool carries_sensor = (a.continuous && a.has_sensor) || (b.continuous && b.has_sensor);
    if ((continuous && !carries_sensor) || !may_overlap(a, b)) continue;
    if (disables_collision(s_.bodies, s_.joints, pair.a, pair.b)) continue;
    wake(s_, pair.a);
    wake(s_, pair.b);
    pose_colliders(s_.bodies[pair.a], s_.colliders);
    pose_colliders(s_.bodies[pair.b], s_.colliders);
    const double margin =
        s_.desc.contact_slop + travel(a, motions_[pair.a], h) + travel(b, motions_[pair.b], h);
    for (std::uint32_t i = a.first_collider; i != kNone; i = s_.colliders[i].next) {
      const Collider& ca = s_.colliders[i];
      const collide::Bounds near = grown(ca.bounds, margin);
      if (!overlap(near, bounds_[pair.b])) continue;
      for (std::uint32_t j = b.first_collider; j != kNone; j = s_.colliders[j].next) {
        const Collider& cb = s_.colliders[j];
        if (!overlap(near, cb.bounds) || !should_collide(ca, cb)) continue;
        if (continuous && (is_swept(a, ca) || is_swept(b, cb))) continue;
        if (sensors_only && !ca.sensor && !cb.sensor) continue;
        if (pushable_or_sensed(a, b, ca, cb))
          discrete_pairs_.push_back(make_pair(s_.colliders, i, j));
      }
    }
  }
  std::sort(discrete_pairs_.begin(), discrete_pairs_.end(),
            [](const ColliderPair& p, const ColliderPair& q) { return p.key < q.key; });
  s_.counters.pairs += static_cast<std::uint32_t>(discrete_pairs_.size());
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
void ImpactStage::add_swept_pairs(std::uint32_t index, std::uint32_t other, double h) {
  wake(s_, other);
  const Body &a = s_.bodies[index], &b = s_.bodies[other];
  const collide::Motion &ma = motions_[index], &mb = motions_[other];
  const ImpactTimes times = impact_times();
  pose_colliders(s_.bodies[index], s_.colliders);
  const double speed = norm(ma.v - mb.v);
  const double wa = norm(ma.w), wb = norm(mb.w);
  for (std::uint32_t i = a.first_collider; i != kNone; i = s_.colliders[i].next) {
    const Collider& ca = s_.colliders[i];
    if (!is_swept(a, ca)) continue;
    const double own = speed + wa * radius_from(ma.x, ca);
    const double far = radius_from(mb.x, ca) + own * h;
    const double margin = s_.desc.contact_slop + (own + wb * far) * h;
    const collide::Bounds near = grown(ca.bounds, margin), from_b = moved(near, -b.T.position());
    for (std::uint32_t j = b.first_collider; j != kNone; j = s_.colliders[j].next) {
      Collider& cb = s_.colliders[j];
      if (b.is_link && !empty(cb.around_line) && !overlap(from_b, cb.around_line)) continue;
      pose_collider(b, cb);
      if (!overlap(near, cb.bounds) || !should_collide(ca, cb)) continue;
      if (b.continuous && other < index && is_swept(b, cb)) continue;
      const double separation =
          times.separation(ca, cb, margin, s_.shapes.manifold_scratch, s_.shapes.manifolds);
      if (separation > margin) continue;
      const ColliderPair pair = make_pair(s_.colliders, i, j);
      swept_pairs_.push_back({pair, pair.a == i, ca.sensor || cb.sensor, separation});
    }
  }
}

// Two continuous bodies are paired once, in the order of their slots. Exception: a sensor that is
// not swept is paired with the swept colliders of the other body.
void ImpactStage::add_swept_pairs_of(const collide::IndexPair& p, double h) {
  if (disables_collision(s_.bodies, s_.joints, p.a, p.b)) return;
  const bool a = swept_body_pairs_.sweeps(p.a), b = swept_body_pairs_.sweeps(p.b);
  if (a) add_swept_pairs(p.a, p.b, h);
  if (b && (!a || s_.bodies[p.a].has_sensor)) add_swept_pairs(p.b, p.a, h);
}

// Finds the swept pairs that touch. Precondition: all bodies are at the same time.
void ImpactStage::find_touching_pairs(double h) {
  swept_pairs_.clear();
  const auto bounds_of_body = [this](std::uint32_t i) -> const collide::Bounds& {
    return bounds_at_pose(s_.bodies[i], s_.colliders);
  };
  for (const collide::IndexPair& p :
       swept_body_pairs_.find(body_motions(), moving_bodies(), s_.desc.contact_slop, h)) {
    if (empty(bounds_[p.a]) || empty(bounds_[p.b])) continue;
    if (!overlap(grown(bounds_of_body(p.a), s_.desc.contact_slop), bounds_of_body(p.b))) continue;
    add_swept_pairs_of(p, 0.0);
  }
  sort_swept_pairs();
}

// Finds the swept pairs that can collide within h. Precondition: all bodies are at the same time.
void ImpactStage::find_swept_pairs(double h) {
  swept_pairs_.clear();
  for (const collide::IndexPair& p :
       swept_body_pairs_.find(body_motions(), moving_bodies(), s_.desc.contact_slop, h)) {
    if (overlap(bounds_[p.a], bounds_[p.b])) add_swept_pairs_of(p, h);
  }
  sort_swept_pairs();
  s_.counters.pairs = std::max(
      s_.counters.pairs, static_cast<std::uint32_t>(discrete_pairs_.size() + swept_pairs_.size()));
}

void ImpactStage::sort_swept_pairs() {
  std::sort(swept_pairs_.begin(), swept_pairs_.end(),
            [](const SweptPair& p, const SweptPair& q) { return p.pair.key < q.pair.key; });
}

}  // namespace vp
