// Which colliders may meet within the rest of the step.
#include <algorithm>

#include "world/impl.h"

namespace vp {

ColliderPair make_pair(const std::vector<Collider>& colliders, std::uint32_t i, std::uint32_t j) {
  if (colliders[i].serial > colliders[j].serial) std::swap(i, j);
  return {(std::uint64_t{colliders[i].serial} << 32) | colliders[j].serial, i, j};
}

bool should_meet(const Collider& a, const Collider& b) {
  return (a.filter.category & b.filter.mask) && (b.filter.category & a.filter.mask) &&
         !(a.sensor && b.sensor);
}

namespace {

bool can_move(const Body& body) {
  return body.motion != Motion::fixed;
}

// Whether any collider of the one may meet any of the other; links of one articulation never do.
bool may_meet(const Body& a, const Body& b) {
  if (!(a.categories & b.masks) || !(b.categories & a.masks)) return false;
  if (a.is_link && a.articulation == b.articulation) return false;
  const bool pushable = a.motion == Motion::dynamic || b.motion == Motion::dynamic;
  return pushable || a.has_sensor || b.has_sensor;
}

bool pushable_or_sensed(const Body& a, const Body& b, const Collider& ca, const Collider& cb) {
  return a.motion == Motion::dynamic || b.motion == Motion::dynamic || ca.sensor || cb.sensor;
}

// No point of the body moves farther than this within h.
double travel(const Body& body, const collide::Motion& m, double h) {
  if (!can_move(body)) return 0.0;
  return (norm(m.v) + norm(m.w) * body.reach) * h;
}

}  // namespace

void World::Impl::refresh_bounds(double h) {
  for (std::uint32_t i = 0; i < bodies.size(); ++i) {
    const Body& body = bodies[i];
    movable[i] = body.alive && can_move(body);
    if (!body.alive || body.first_collider == kNone) {
      bounds[i] = {};
    } else if (body.unbounded) {
      bounds[i] = bounds_at_pose(i);
    } else {
      bounds[i] = grown(bounds_at_pose(i), desc.contact_slop + travel(body, motions[i], h));
    }
  }
}

const collide::Bounds& World::Impl::bounds_at_pose(std::uint32_t index) {
  Body& body = bodies[index];
  if (body.bounded) return body.bounds;
  body.bounded = true;
  body.bounds =
      collide::empty(body.local) ? collide::Bounds{} : collide::transformed(body.T, body.local);
  if (body.unbounded) {
    // The bounds of a plane's body enclose those of its colliders, planes included.
    pose_colliders(index);
    for (std::uint32_t c = body.first_collider; c != kNone; c = colliders[c].next) {
      body.bounds = merged(body.bounds, colliders[c].bounds);
    }
  }
  return body.bounds;
}

void World::Impl::pose_colliders(std::uint32_t index) {
  Body& body = bodies[index];
  body.wanted = false;
  if (body.posed) return;
  body.posed = true;
  for (std::uint32_t c = body.first_collider; c != kNone; c = colliders[c].next) {
    Collider& collider = colliders[c];
    collider.T = body.T * collider.T_body_shape;
    collider.bounds = bounds_of(collider.geometry, collider.T);
  }
}

double World::Impl::discrete_margin(const ColliderPair& pair, double h) const {
  const std::uint32_t a = colliders[pair.a].body, b = colliders[pair.b].body;
  return desc.contact_slop + travel(bodies[a], motions[a], h) + travel(bodies[b], motions[b], h);
}

// Spheres of a continuous body are swept. What else it carries are sensors; they look where they
// are at the start of a step.
bool World::Impl::swept(const Collider& a, const Collider& b) const {
  const auto sweeps = [&](const Collider& c) {
    return bodies[c.body].continuous && c.geometry.kind == collide::Kind::sphere;
  };
  return sweeps(a) || sweeps(b);
}

// Bounds of what may meet a link, or a sensor that a continuous body carries, the others' empty;
// false if there are no two.
bool World::Impl::keep_discrete_bounds() {
  std::uint32_t categories = 0, masks = 0;
  collide::Bounds around;
  const auto takes_part = [](const Body& body) {
    return body.alive && body.first_collider != kNone && (!body.continuous || body.has_sensor);
  };
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    const Body& body = bodies[i];
    if (!takes_part(body)) continue;
    categories |= body.categories;
    masks |= body.masks;
    if (body.is_link || body.continuous) around = merged(around, bounds[i]);
  }
  int meeting = 0;
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    const Body& body = bodies[i];
    const bool meets = takes_part(body) && (body.categories & masks) && (body.masks & categories) &&
                       overlap(bounds[i], around);
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
    pose_colliders(pair.a);
    pose_colliders(pair.b);
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
  const Collider& sphere = colliders[p.sphere_is_a ? p.pair.a : p.pair.b];
  const Collider& other = colliders[p.sphere_is_a ? p.pair.b : p.pair.a];
  return {sphere.T.position(),
          sphere.geometry.radius,
          motions[sphere.body],
          &other.geometry,
          other.T,
          motions[other.body],
          h,
          0.05 * desc.contact_slop};
}

// Of shapes with parts it is known only as far as they touch: what is farther apart is as far as
// the margin.
double World::Impl::swept_separation(const Collider& ball, const Collider& other, double margin) {
  if (!has_parts(ball.geometry, other.geometry)) {
    const Vec3 local = inverse_times(other.T, ball.T.position());
    return signed_distance(other.geometry, local).distance - ball.geometry.radius;
  }
  double least = margin;
  manifolds.clear();
  collide::PairCache cache;
  find_manifolds(ball.geometry, ball.T, other.geometry, other.T, desc.contact_slop, cache, {},
                 manifold_scratch, manifolds);
  for (const collide::SubManifold& found : manifolds) {
    for (int k = 0; k < found.manifold.count; ++k) {
      least = std::min(least, found.manifold.points[k].separation);
    }
  }
  return least;
}

// Pairs of a continuous body's colliders with those of another body that can meet within h.
void World::Impl::add_swept_pairs(std::uint32_t index, std::uint32_t other, double h) {
  wake(other);
  const Body &a = bodies[index], &b = bodies[other];
  const collide::Motion &ma = motions[index], &mb = motions[other];
  pose_colliders(index);
  pose_colliders(other);
  const double speed = norm(ma.v - mb.v);
  const double wa = norm(ma.w), wb = norm(mb.w);
  for (std::uint32_t i = a.first_collider; i != kNone; i = colliders[i].next) {
    const Collider& ball = colliders[i];
    if (ball.geometry.kind != collide::Kind::sphere) continue;  // a sensor of another shape
    const double own = speed + wa * norm(ball.T.position() - ma.x);
    const double far = norm(ball.T.position() - mb.x) + own * h;
    const double margin = desc.contact_slop + (own + wb * far) * h;
    const collide::Bounds near = grown(ball.bounds, margin);
    for (std::uint32_t j = b.first_collider; j != kNone; j = colliders[j].next) {
      const Collider& cb = colliders[j];
      if (!overlap(near, cb.bounds) || !should_meet(ball, cb)) continue;
      if (b.continuous && other < index && cb.geometry.kind == collide::Kind::sphere) continue;
      const double separation = swept_separation(ball, cb, margin);
      if (separation > margin) continue;
      const ColliderPair pair = make_pair(colliders, i, j);
      swept_pairs.push_back({pair, pair.a == i, ball.sensor || cb.sensor, separation});
    }
  }
}

void World::Impl::find_swept_pairs(double h) {
  swept_pairs.clear();
  for (std::uint32_t i = 0; i < bodies.size(); ++i) {
    if (!bodies[i].alive || !bodies[i].continuous) continue;
    for (std::uint32_t j = 0; j < bodies.size(); ++j) {
      // Two continuous bodies meet once, in the order of their slots, but for sensors: those of no
      // sphere are found by the other's spheres.
      if (j == i || !overlap(bounds[i], bounds[j])) continue;
      if (bodies[j].continuous && j < i && !bodies[j].has_sensor) continue;
      if (may_meet(bodies[i], bodies[j])) add_swept_pairs(i, j, h);
    }
  }
  std::sort(swept_pairs.begin(), swept_pairs.end(),
            [](const SweptPair& p, const SweptPair& q) { return p.pair.key < q.pair.key; });
  counters.pairs = std::max(counters.pairs,
                            static_cast<std::uint32_t>(discrete_pairs.size() + swept_pairs.size()));
}

}  // namespace vp
