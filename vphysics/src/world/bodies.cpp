// Per-step work on bodies: poses, lists, solver states, enlarged bounds.
#include <algorithm>
#include <cmath>
#include <utility>

#include "solve/state_vector.h"
#include "world/impl.h"
#include "world/prefetch.h"
#include "world/restarts.h"
#include "world/validate.h"

namespace vp {
namespace {

// Margin of enlarged bounds, in sizes of the collider. With larger margins bounds are left less
// often but overlap more neighbours.
constexpr double kMargin = 0.1;
// Whether the body stays within all its enlarged bounds: within half a margin of its smallest
// collider (update_bounds). Sums of components are upper bounds of the lengths.
bool stays_within_bounds(const Body& body, const solve::BodyState& state, float dt) {
  const float *at = body.bounded_at, *displacement = state.displacement, *velocity = state.velocity;
  const auto moved = [&](int i) {
    return std::fabs(displacement[i] - at[i]) + dt * std::fabs(velocity[i]);
  };
  const float linear = moved(0) + moved(1) + moved(2), rotated = moved(3) + moved(4) + moved(5);
  return static_cast<double>(linear) + body.bounding_radius * static_cast<double>(rotated) <
         0.5 * kMargin * body.min_size;
}
// Bounds of everything that a collider sweeps in a step.
collide::Bounds bounds_along(const collide::Bounds& b, const Vec3& displacement, double more) {
  const collide::Bounds end{b.lower + displacement, b.upper + displacement};
  return grown(merged(b, end), more);
}

// A kinematic body that accelerates faster, in multiples of gravity and in length units [m/s^2] at
// least, does the rest at the start of the step. At the end of an acceleration it overshoots by
// half of what it gains in a step: this bounds the speed at which it throws what it carries.
constexpr double kMaxOfGravity = 2.0, kMaxSteadyAcceleration = 20.0;

// The part of an acceleration that continues the last one, each component for itself.
Vec3 continued(const Vec3& now, const Vec3& last, double limit) {
  const auto smaller = [limit](double a, double b) {
    return a * b > 0.0 ? std::copysign(std::min({std::fabs(a), std::fabs(b), limit}), a) : 0.0;
  };
  return {smaller(now.x, last.x), smaller(now.y, last.y), smaller(now.z, last.z)};
}

// The body's origin moves along the chord to where its twist takes it. Returns the change of
// velocity within the step, about the mean: of a motion with a steady acceleration, the
// acceleration times dt. A sudden change of velocity acts at the start of the step.
Velocity prescribe_velocity(Body& body, double dt, const WorldDesc& desc) {
  const SE3 end = body.T * Exp(dt * body.prescribed);
  const Velocity before{body.w, body.v};
  body.w = body.T.rotate(body.prescribed.w);
  body.v = (1.0 / dt) * (end.position() - body.T.position());
  const Velocity now{(1.0 / dt) * (body.w - before.w), (1.0 / dt) * (body.v - before.v)};
  const Velocity last = std::exchange(body.last_acceleration, now);
  const double limit =
      std::max(kMaxOfGravity * norm(desc.gravity), kMaxSteadyAcceleration * desc.length_unit);
  const double angular = limit / std::max(body.bounding_radius, 1e-6 * desc.length_unit);
  return {dt * continued(now.w, last.w, angular), dt * continued(now.v, last.v, limit)};
}

// The angular velocity of a body after rotation to `next` at a constant twist. It conserves the
// angular momentum. If that would increase the energy, it is constant in the body's frame instead.
Vec3 mean_rate(const Body& body, const Mat3& next) {
  const Mat3& R = body.T.rotation();
  const Vec3 was = transposed_times(R, body.w), momentum = R * (body.central * was);
  const Vec3 w = next * (body.inverse_central * transposed_times(next, momentum));
  return dot(w, momentum) > dot(body.w, momentum) ? next * was : w;
}

}  // namespace

void set_pose(Body& body, const Vec3& reference, const Mat3& R) {
  const bool at_centre = body.motion == Motion::dynamic && !body.is_link;
  body.T = SE3(R, at_centre ? reference - R * body.centre : reference);
  body.moved();
}

void advance_body(Body& body, const collide::Motion& m, double h, bool freely, const Vec3& more_w) {
  const bool tumbles = body.tumbles();
  if (freely && tumbles && body.rotates_freely()) {
    const Rotated free = rotated_freely(body, h, more_w);
    body.w = free.w;
    return set_pose(body, m.x + h * m.v, free.R);
  }
  const Mat3& R = body.T.rotation();
  const bool turns = m.w.x != 0.0 || m.w.y != 0.0 || m.w.z != 0.0;
  const Mat3 next = turns ? rotated(R, h * m.w) : R;
  if (tumbles && turns && !body.precesses) {
    body.w = body.rotates_freely() ? mean_rate(body, next) : rate_at(body, next);
  }
  set_pose(body, m.x + h * m.v, next);
}

bool never_collide(const Body& a, const Body& b) {
  if (!a.is_link || a.articulation != b.articulation) return false;
  const LinkNeighbours &p = a.neighbours, &q = b.neighbours;
  return p.leader == q.leader || p.head == q.head || p.base == q.leader || p.leader == q.base;
}

bool may_overlap(const Body& a, const Body& b) {
  if (!(a.categories & b.masks) || !(b.categories & a.masks)) return false;
  if (never_collide(a, b)) return false;
  const bool pushable = a.motion == Motion::dynamic || b.motion == Motion::dynamic;
  return pushable || a.has_sensor || b.has_sensor;
}

solve::ContactGraph::End end_of(const Bodies& bodies, std::uint32_t body) {
  const Body& b = bodies[body];
  if (b.motion == Motion::fixed) return {solve::kWorldState, false, solve::kSharedRegion};
  return {body + 1, b.motion == Motion::dynamic, b.region};
}

bool BodyLists::refresh(const Bodies& bodies) {
  if (!dirty_) return false;
  dirty_ = false;
  impacts_are_dirty_ = true;
  awake_bodies.clear();
  links.clear();
  some_continuous = some_sub_stepped = some_sleep = false;
  for (std::uint32_t i = 0; i < bodies.size(); ++i) {
    const Body& body = bodies[i];
    if (!body.alive) continue;
    if (body.is_link) {
      if (body.first_collider != kNone) links.push_back(i);
    } else if (body.asleep) {
      some_sleep = true;
    } else if (body.motion != Motion::fixed) {
      awake_bodies.push_back(i);
      (body.continuous ? some_continuous : some_sub_stepped) = true;
    }
  }
  return true;
}

const std::vector<std::uint32_t>& BodyLists::of_impacts(const Bodies& bodies) {
  if (!impacts_are_dirty_) return of_impacts_;
  impacts_are_dirty_ = false;
  of_impacts_.clear();
  for (std::uint32_t i = 0; i < bodies.size(); ++i) {
    const Body& body = bodies[i];
    if (!body.alive || body.motion == Motion::fixed || body.remote) continue;
    if (!body.is_link || body.first_collider != kNone) of_impacts_.push_back(i);
  }
  return of_impacts_;
}

void World::Impl::list_bodies() {
  if (!lists.refresh(bodies)) return;
  regions.sort(bodies, lists.awake_bodies);
  impacts.list_bodies();
  row_solve.reserve();
}

bool stop_if_out_of_range(const StepContext& s, std::uint32_t index, const SE3& start) {
  Body& body = s.bodies[index];
  if (in_range(body.w) && in_range(body.v) && in_range(body.T.position())) return false;
  s.status.non_finite = true;
  body.w = body.v = {};
  body.prescribed = {};
  body.last_acceleration = {};
  body.T = start;
  body.moved();
  restart_displacement(s, index, false);  // the others are at different times of the step
  forget_joints(s.bodies[index], s.joints);
  return true;
}

void World::Impl::load_states(double dt) {
  constexpr std::uint8_t kFar = 1, kLeaves = 2, kPulled = 4, kAccelerates = 8, kWobbles = 16;
  sub_step.awake_body_changed.resize(lists.awake_bodies.size());
  const BodyStates step = context.states_in(dt);
  const Approach approach = context.approach_in(dt);
  workers.in_parallel(
      lists.awake_bodies.size(), kBodyGrain, [&](std::size_t begin, std::size_t end) {
        for (std::size_t k = begin; k < end; ++k) {
          const std::uint32_t i = lists.awake_bodies[k];
          Body& body = bodies[i];
          Velocity change;
          if (body.motion == Motion::kinematic) change = prescribe_velocity(body, dt, desc);
          const bool far = step.load(body, i);
          const bool accelerates = !(change == Velocity{});
          if (accelerates) step.set_acceleration(i, change);
          const bool stays = joins_sub_steps(body) &&
                             stays_within_bounds(body, body_states[i + 1], static_cast<float>(dt));
          if (far || !stays) pose_colliders(body, colliders);
          const bool pulled = !(approach.pull_of(body) == Velocity{});
          sub_step.awake_body_changed[k] = static_cast<std::uint8_t>(
              (far ? kFar : 0) | (step.wobbles(body, i) ? kWobbles : 0) | (pulled ? kPulled : 0) |
              (far || !stays ? kLeaves : 0) | (accelerates ? kAccelerates : 0));
        }
      });
  const auto changed_at = [&](std::size_t k) {
    return sub_step.awake_body_changed[k] == 0 ? kNone : lists.awake_bodies[k];
  };
  sub_step.restarts.reserve(bodies.size());
  for (std::size_t k = 0; k < lists.awake_bodies.size(); ++k) {
    const std::uint8_t changed = sub_step.awake_body_changed[k];
    if ((changed & (kFar | kWobbles)) != 0)
      sub_step.restarts.add(lists.awake_bodies[k], (changed & kWobbles) == 0);
  }
  sub_step.restarts.run(context);
  for (std::size_t k = 0; k < lists.awake_bodies.size(); ++k) {
    prefetch_bodies(context, changed_at, k, lists.awake_bodies.size());
    const std::uint32_t i = changed_at(k);
    if (i == kNone) continue;
    if ((sub_step.awake_body_changed[k] & kAccelerates) != 0) sub_step.accelerating.push_back(i);
    if (sub_step.awake_body_changed[k] == kAccelerates) continue;
    if ((sub_step.awake_body_changed[k] & kPulled) != 0)
      contact_store.mark_contacts_dirty(bodies[i]);
    if (bodies[i].first_collider != kNone)
      update_bounds(context, i, dt, joins_sub_steps(bodies[i]));
  }
}

namespace {

// What the colliders of a body sweep within h.
class SweptBounds {
 public:
  SweptBounds(const Stores& s, const Body& body, double h)
      : s_(s),
        body_(body),
        h_(h),
        pull_(s.approach_in(h).pull_of(body)),
        rotation_(h * (norm(body.w) + norm(pull_.w))),
        reference_(reference_point(body)) {}

  // Calls f(collider, bounds, displacement) with those of each collider, grown by `share` of its
  // margin, until f returns false; returns whether it never did.
  template <class F>
  bool each(double share, const F& f) const {
    for (std::uint32_t c = body_.first_collider; c != kNone; c = s_.colliders[c].next) {
      const Collider& collider = s_.colliders[c];
      // Its centre moves along an arc, which deviates from its tangent by half the squared angle.
      const Vec3 arm = body_.T * collider.centre - reference_;
      const Vec3 displacement = h_ * (body_.v + cross(body_.w, arm));
      const double own = collider.geometry.kind == collide::Kind::sphere ? 0.0 : collider.radius;
      const double more =
          rotation_ * own + 0.5 * rotation_ * rotation_ * norm(arm) + s_.desc.contact_slop;
      const Vec3 pulled = h_ * (pull_.v + cross(pull_.w, arm));
      const collide::Bounds start = bounds_along(collider.bounds, pulled, 0.0);
      const double margin = share * kMargin * collider.size;
      if (!f(collider, bounds_along(start, displacement, more + margin), displacement + pulled))
        return false;
    }
    return true;
  }

 private:
  const Stores& s_;
  const Body& body_;
  double h_;
  Velocity pull_;
  double rotation_;  // [rad], at most
  Vec3 reference_;
};

}  // namespace

void update_bounds(const Stores& s, std::uint32_t index, double h, bool is_solver_driven) {
  Body& body = s.bodies[index];
  pose_colliders(body, s.colliders);
  // Half of the margin remains now, whether the enlarged bounds are new or old.
  (void)SweptBounds(s, body, h)
      .each(0.5,
            [&](const Collider& collider, const collide::Bounds& swept, const Vec3& displacement) {
              const double half = 0.5 * kMargin * collider.size;
              s.finder.set_bounds(collider.proxy, swept, half, 2.0 * displacement);
              return true;
            });
  if (is_solver_driven) std::copy_n(s.body_states[index + 1].displacement, 6, body.bounded_at);
}

bool has_bounds_for(const Stores& s, std::uint32_t index, double h) {
  pose_colliders(s.bodies[index], s.colliders);
  return SweptBounds(s, s.bodies[index], h)
      .each(0.0, [&](const Collider& collider, const collide::Bounds& swept, const Vec3&) {
        return s.finder.holds(collider.proxy, swept);
      });
}

Velocity World::Impl::settle(const BodyStates& states, std::uint32_t index) {
  Velocity more;
  if (!states.settle(bodies[index], index, more)) {
    status.non_finite = true;
    lost_bodies.push_back(index);
  }
  return more;
}

// Runs after settle() of all bodies: the set of lost bodies does not depend on an order, and no NaN
// displacement enters a remaining contact.
void World::Impl::forget_lost_bodies() {
  for (const std::uint32_t i : lost_bodies) {
    std::fill_n(body_states[i + 1].displacement, 6, 0.0f);
    std::fill_n(bodies[i].bounded_at, 6, 1e9f);
  }
  for (const std::uint32_t i : lost_bodies) {
    forget_contacts(i);
    forget_joints(bodies[i], joints);
  }
  lost_bodies.clear();
}

// Discards the impulses of its contact slots: they are not used for a warm start.
void World::Impl::forget_contacts(std::uint32_t body) {
  contact_store.for_each_of(bodies[body], [&](std::uint32_t index, const Contact& c) {
    contact_store.mark_dirty(index);
    if (c.is_part()) {
      contact_store.forget_part(index, body_set);
    } else if (c.slot.points > 0) {
      contact_store.release_slot(index, body_set);
      contact_store.set_speculative(index, {}, body_set);
    } else if (!c.parked) {
      contact_store.reset_speculative(c, body_set);
    }
  });
}

// After the user changed the pose.
void World::Impl::jumped(std::uint32_t index) {
  ready_for_queries = false;
  Body& body = bodies[index];
  wake(index);
  wake_neighbours(index);
  contact_store.mark_contacts_dirty(bodies[index]);
  std::fill_n(body.bounded_at, 6, 1e9f);
  if (body.motion != Motion::fixed) return;
  impacts.invalidate_pairs();
  pose_colliders(bodies[index], colliders);
  for (std::uint32_t c = body.first_collider; c != kNone; c = colliders[c].next) {
    finder.set_bounds(colliders[c].proxy, colliders[c].bounds, kMargin * colliders[c].size);
  }
}

void World::Impl::add_proxy(std::uint32_t index) {
  ready_for_queries = false;
  Collider& collider = colliders[index];
  Body& body = bodies[collider.body];
  pose_colliders(body, colliders);
  collide::ProxyDesc proxy;
  proxy.bounds = collider.bounds;
  proxy.mobility =
      body.motion == Motion::fixed ? collide::Mobility::fixed : collide::Mobility::moving;
  // Continuous bodies find their pairs themselves (pairs.cpp).
  proxy.category = body.continuous ? 0 : collider.filter.category;
  proxy.mask = body.continuous ? 0 : collider.filter.mask;
  // Of links that collide with each other: the group of links fixed together.
  const int leader = body.neighbours.leader;
  proxy.owner = !body.is_link      ? collider.body
                : leader == kWorld ? 0x80000000u + body.articulation
                                   : articulations[body.articulation].body_of(leader);
  proxy.user = index;
  proxy.margin = kMargin * collider.size;
  collider.proxy = finder.add(proxy);
}

}  // namespace vp
