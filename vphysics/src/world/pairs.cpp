// Which colliders may meet within the rest of the step.
#include <algorithm>

#include "world/impl.h"

namespace vp {

namespace {

bool can_move(const Body& body) {
  return body.motion != Motion::fixed;
}

bool pushable_or_sensed(const Body& a, const Body& b, const Collider& ca, const Collider& cb) {
  return a.motion == Motion::dynamic || b.motion == Motion::dynamic || ca.sensor || cb.sensor;
}

// How much larger than what a body may reach its kept bounds are: contact slops, for who is pushed
// a little, and ways of a step, so that they hold for some steps. Each candidate costs a comparison
// in every round.
constexpr double kCandidateSlops = 10.0, kCandidateSteps = 2.0;
// So many look for others one by one, each among all bodies; more, and all are sorted.
constexpr std::size_t kFewLeavers = 6;

// No point of the body moves farther than this within h.
double travel(const Body& body, const collide::Motion& m, double h) {
  if (!can_move(body)) return 0.0;
  return (norm(m.v) + norm(m.w) * body.reach) * h;
}
// The same of the body's own bounds: where they hold however it turns, turning does not count.
double travel_of_bounds(const Body& body, const collide::Motion& m, double h) {
  return collide::empty(body.around_line) ? travel(body, m, h) : norm(m.v) * h;
}

}  // namespace

void World::Impl::refresh_bounds(double h) {
  if (!candidates_are_stale) {
    for (const std::uint32_t i : impact_bodies()) refresh_bounds_of(i, h);
    return;
  }
  for (std::uint32_t i = 0; i < bodies.size(); ++i) {
    if (!remote_bodies[i]) refresh_bounds_of(i, h);
  }
}
void World::Impl::refresh_bounds_of(std::uint32_t i, double h) {
  const Body& body = bodies[i];
  movable[i] = body.alive && can_move(body);
  if (!body.alive || body.first_collider == kNone) {
    bounds[i] = {};
  } else if (body.unbounded) {
    bounds[i] = bounds_at_pose(bodies[i], colliders);
  } else {
    bounds[i] = grown(bounds_at_pose(bodies[i], colliders),
                      desc.contact_slop + travel_of_bounds(body, motions[i], h));
  }
}

double World::Impl::discrete_margin(const ColliderPair& pair, double h) const {
  const std::uint32_t a = colliders[pair.a].body, b = colliders[pair.b].body;
  return desc.contact_slop + travel(bodies[a], motions[a], h) + travel(bodies[b], motions[b], h);
}

// What a continuous body carries is swept, but for sensors that are no spheres: they look where
// they are at the start of a step.
bool World::Impl::is_swept(const Collider& c) const {
  return bodies[c.body].continuous && (!c.sensor || c.geometry.kind == collide::Kind::sphere);
}
bool World::Impl::swept(const Collider& a, const Collider& b) const {
  return is_swept(a) || is_swept(b);
}

namespace {

bool meets_discretely(const Body& body) {
  return body.alive && body.first_collider != kNone && (!body.continuous || body.has_sensor);
}

}  // namespace

void World::Impl::list_discrete_filters() {
  discrete_categories = discrete_masks = 0;
  for (const Body& body : bodies) {
    if (!meets_discretely(body)) continue;
    discrete_categories |= body.categories;
    discrete_masks |= body.masks;
  }
}

// Bounds of what may meet a link, or a sensor that a continuous body carries, the others' empty;
// false if there are no two.
bool World::Impl::keep_discrete_bounds() {
  const std::uint32_t categories = discrete_categories, masks = discrete_masks;
  if ((categories & masks) == 0) return false;
  collide::Bounds around;
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    const Body& body = bodies[i];
    if (meets_discretely(body) && (body.is_link || body.continuous))
      around = merged(around, bounds[i]);
  }
  int meeting = 0;
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    const Body& body = bodies[i];
    const bool meets = meets_discretely(body) && (body.categories & masks) &&
                       (body.masks & categories) && overlap(bounds[i], around);
    discrete_bounds[i] = meets ? bounds[i] : collide::Bounds{};
    meeting += meets ? 1 : 0;
  }
  return meeting > 1;
}

// Pairs in which nothing is swept.
void World::Impl::find_discrete_pairs(double h) {
  body_pairs.clear();
  discrete_pairs.clear();
  if (!keep_discrete_bounds()) return;
  broad_phase.find_pairs(discrete_bounds, movable, body_pairs);
  for (const collide::IndexPair& pair : body_pairs) {
    const Body &a = bodies[pair.a], &b = bodies[pair.b];
    const bool continuous = a.continuous || b.continuous;
    if (!continuous && !a.is_link && !b.is_link) continue;  // of the sub-stepped solver
    const bool sensors_only = in_sub_steps(a, b);
    const bool carries_sensor = (a.continuous && a.has_sensor) || (b.continuous && b.has_sensor);
    if ((continuous && !carries_sensor) || !may_meet(a, b)) continue;
    wake(pair.a);
    wake(pair.b);
    pose_colliders(bodies[pair.a], colliders);
    pose_colliders(bodies[pair.b], colliders);
    const double margin =
        desc.contact_slop + travel(a, motions[pair.a], h) + travel(b, motions[pair.b], h);
    for (std::uint32_t i = a.first_collider; i != kNone; i = colliders[i].next) {
      const Collider& ca = colliders[i];
      const collide::Bounds near = grown(ca.bounds, margin);
      if (!overlap(near, bounds[pair.b])) continue;
      for (std::uint32_t j = b.first_collider; j != kNone; j = colliders[j].next) {
        const Collider& cb = colliders[j];
        if (!overlap(near, cb.bounds) || !should_meet(ca, cb)) continue;
        if (continuous && swept(ca, cb)) continue;
        if (sensors_only && !ca.sensor && !cb.sensor) continue;
        if (pushable_or_sensed(a, b, ca, cb)) discrete_pairs.push_back(make_pair(colliders, i, j));
      }
    }
  }
  std::sort(discrete_pairs.begin(), discrete_pairs.end(),
            [](const ColliderPair& p, const ColliderPair& q) { return p.key < q.key; });
  counters.pairs += static_cast<std::uint32_t>(discrete_pairs.size());
}

collide::SweepQuery World::Impl::sweep_query(const SweptPair& p, double h) const {
  const Collider& sphere = colliders[p.swept_is_a ? p.pair.a : p.pair.b];
  const Collider& other = colliders[p.swept_is_a ? p.pair.b : p.pair.a];
  return {sphere.T.position(),
          sphere.geometry.radius,
          motions[sphere.body],
          &other.geometry,
          other.T,
          motions[other.body],
          h,
          swept_tolerance()};
}

// Until the separation comes down to target; negative: not within h. A sphere has closed forms,
// which the general way would only find more slowly.
double World::Impl::time_until(const SweptPair& p, double target, double h) {
  const Collider &c = colliders[p.swept_is_a ? p.pair.a : p.pair.b],
                 &other = colliders[p.swept_is_a ? p.pair.b : p.pair.a];
  if (c.geometry.kind == collide::Kind::sphere) return time_of_impact(sweep_query(p, h), target);
  const collide::ImpactQuery query{{&c.geometry, c.T, motions[c.body]},
                                   {&other.geometry, other.T, motions[other.body]},
                                   h,
                                   swept_tolerance()};
  // What of a surface has come near but is no contact (inner edges, backs) would hold the body
  // where it is: the solver has nothing that pushes it away.
  const auto near =
      is_surface(other.geometry) ? collide::NearParts::passed : collide::NearParts::met;
  collide::PartsImpact found{};
  return first_impact(query, target, parts_scratch, found, near) ? found.time : -1.0;
}

// Of shapes with parts it is known only as far as they touch: what is farther apart is as far as
// the margin.
double World::Impl::swept_separation(const Collider& moving, const Collider& other, double margin) {
  if (!has_parts(moving.geometry, other.geometry)) {
    if (moving.geometry.kind != collide::Kind::sphere) {
      collide::PairCache fresh;
      return closest_points(moving.geometry, moving.T, other.geometry, other.T, fresh).distance;
    }
    const Vec3 local = inverse_times(other.T, moving.T.position());
    return signed_distance(other.geometry, local).distance - moving.geometry.radius;
  }
  double least = margin;
  manifolds.clear();
  collide::PairCache cache;
  find_manifolds(moving.geometry, moving.T, other.geometry, other.T, desc.contact_slop, cache, {},
                 manifold_scratch, manifolds);
  for (const collide::SubManifold& found : manifolds) {
    for (int k = 0; k < found.manifold.count; ++k) {
      least = std::min(least, found.manifold.points[k].separation);
    }
  }
  return least;
}

namespace {

// To the farthest point of what turns with the collider, or of a sphere to its centre.
double reach_from(const Vec3& x, const Collider& c) {
  if (c.geometry.kind == collide::Kind::sphere) return norm(c.T.position() - x);
  if (c.geometry.kind != collide::Kind::compound) {
    return norm(c.T * core_middle(c.geometry) - x) + core_reach(c.geometry);
  }
  const collide::Bounds& b = c.bounds;
  return norm(0.5 * (b.lower + b.upper) - x) + 0.5 * norm(b.upper - b.lower);
}

}  // namespace

// Pairs of a continuous body's colliders with those of another body that can meet within h.
void World::Impl::add_swept_pairs(std::uint32_t index, std::uint32_t other, double h) {
  wake(other);
  const Body &a = bodies[index], &b = bodies[other];
  const collide::Motion &ma = motions[index], &mb = motions[other];
  pose_colliders(bodies[index], colliders);
  const double speed = norm(ma.v - mb.v);
  const double wa = norm(ma.w), wb = norm(mb.w);
  for (std::uint32_t i = a.first_collider; i != kNone; i = colliders[i].next) {
    const Collider& ca = colliders[i];
    if (!is_swept(ca)) continue;
    const double own = speed + wa * reach_from(ma.x, ca);
    const double far = reach_from(mb.x, ca) + own * h;
    const double margin = desc.contact_slop + (own + wb * far) * h;
    const collide::Bounds near = grown(ca.bounds, margin);
    for (std::uint32_t j = b.first_collider; j != kNone; j = colliders[j].next) {
      Collider& cb = colliders[j];
      if (!empty(cb.around_line) && !overlap(near, moved(cb.around_line, b.T.position()))) continue;
      pose_collider(b, cb);
      if (!overlap(near, cb.bounds) || !should_meet(ca, cb)) continue;
      if (b.continuous && other < index && is_swept(cb)) continue;
      const double separation = swept_separation(ca, cb, margin);
      if (separation > margin) continue;
      const ColliderPair pair = make_pair(colliders, i, j);
      swept_pairs.push_back({pair, pair.a == i, ca.sensor || cb.sensor, separation});
    }
  }
}

void World::Impl::keep_bounds(std::uint32_t index, double h) {
  const collide::Bounds& now = bounds[index];
  const double margin = kCandidateSlops * desc.contact_slop +
                        kCandidateSteps * travel_of_bounds(bodies[index], motions[index], h);
  kept_bounds[index] = collide::empty(now) ? now : grown(now, margin);
}

void World::Impl::list_candidates(double h) {
  candidates_are_stale = false;
  kept_bounds.resize(bodies.size());
  sweeps.resize(bodies.size());
  for (std::uint32_t i = 0; i < bodies.size(); ++i) {
    sweeps[i] = bodies[i].alive && bodies[i].continuous;
    keep_bounds(i, h);
  }
  candidates.clear();
  candidate_phase.find_pairs(kept_bounds, sweeps, candidates);
  std::erase_if(candidates, [this](const collide::IndexPair& p) {
    return !may_meet(bodies[p.a], bodies[p.b]);
  });
}

void World::Impl::find_candidates_of(std::uint32_t index) {
  std::erase_if(candidates,
                [index](const collide::IndexPair& p) { return p.a == index || p.b == index; });
  for (std::uint32_t j = 0; j < bodies.size(); ++j) {
    if (j == index || !(sweeps[index] || sweeps[j]) || collide::empty(kept_bounds[j])) continue;
    if (!overlap(kept_bounds[index], kept_bounds[j]) || !may_meet(bodies[index], bodies[j]))
      continue;
    candidates.push_back({std::min(index, j), std::max(index, j)});
  }
}

// Who has left its kept bounds looks for others anew, alone or, if many have, with all.
void World::Impl::refresh_candidates(double h) {
  if (candidates_are_stale) return list_candidates(h);
  leavers.clear();
  for (const std::uint32_t i : impact_bodies()) {
    if (!holds(kept_bounds[i], bounds[i])) leavers.push_back(i);
  }
  if (leavers.size() > kFewLeavers + bodies.size() / 64) return list_candidates(h);
  for (const std::uint32_t i : leavers) keep_bounds(i, h);
  for (const std::uint32_t i : leavers) find_candidates_of(i);
}

void World::Impl::find_swept_pairs(double h) {
  swept_pairs.clear();
  refresh_candidates(h);
  // Two continuous bodies meet once, in the order of their slots, but for sensors: those that are
  // not swept are found by what the other sweeps.
  for (const collide::IndexPair& p : candidates) {
    if (!overlap(bounds[p.a], bounds[p.b])) continue;
    if (sweeps[p.a]) add_swept_pairs(p.a, p.b, h);
    if (sweeps[p.b] && (!sweeps[p.a] || bodies[p.a].has_sensor)) add_swept_pairs(p.b, p.a, h);
  }
  std::sort(swept_pairs.begin(), swept_pairs.end(),
            [](const SweptPair& p, const SweptPair& q) { return p.pair.key < q.pair.key; });
  counters.pairs = std::max(counters.pairs,
                            static_cast<std::uint32_t>(discrete_pairs.size() + swept_pairs.size()));
}

}  // namespace vp
