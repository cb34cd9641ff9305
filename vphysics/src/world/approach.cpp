#include "world/approach.h"

#include <algorithm>

#include "world/free_rotation.h"
#include "world/solver_limits.h"

namespace vp {
namespace {

// Margins allow for accelerations up to this [m/s^2], a few times that of gravity: contacts that
// their displacements cause are found in the next step. For a stronger one, margins include its
// displacement.
constexpr double kBornePull = 50.0;

}  // namespace

// The fast path: most bodies have gravity alone, which the margins allow for.
Velocity Approach::pull_of(const Body& body) const {
  if (body.motion != Motion::dynamic || body.is_link || body.asleep) return {};
  if (body.load == kNone) {
    const Vec3 gravity = body.gravity_scale * desc.gravity;
    if (dot(gravity, gravity) <= kBornePull * kBornePull) return {};
  }
  const Velocity a = loads.acceleration(body, desc.gravity);
  const double acceleration_bound = norm(a.v) + body.bounding_radius * norm(a.w);
  if (acceleration_bound <= kBornePull || dt * dt * acceleration_bound <= desc.contact_slop)
    return {};
  const double mean = 0.5 * dt * (1.0 + 1.0 / sub_steps_in(desc, speed_unit, dt));
  return {mean * a.w, mean * a.v};
}

namespace {

// How far the impulses of contacts and joints may move a body within a step, beside its motion at
// its velocity [m]. A push that moves it by much more has its contacts searched for again.
double pushed_by_others(const Body& body) {
  constexpr double kPushed = 0.04;  // of its smallest half extent
  const bool pushed =
      body.motion == Motion::dynamic && (body.contact_slots > 0 || body.first_joint != kNone);
  return pushed ? kPushed * body.min_size : 0.0;
}

// How far the change of its angular velocity in free rotation may move a body's points within a
// step, beside its motion at its velocity [m].
double moved_by_tumbling(const Body& body, double dt) {
  if (!body.tumbles() || hardly_rotates(body.w, dt)) return 0.0;
  const Vec3 w = transposed_times(body.T.rotation(), body.w);
  const Vec3 acceleration = body.inverse_central * cross(body.central * w, w);
  return 0.5 * dt * dt * norm(acceleration) * body.bounding_radius;
}

// One of the two bodies, for this step.
struct Approaching {
  const Body& body;
  Vec3 reference;
  Velocity pull;
  bool pulled;

  Approaching(const Body& b, const Velocity& p)
      : body(b), reference(reference_point(b)), pull(p), pulled(!(p == Velocity{})) {}

  Vec3 velocity(const Vec3& at) const { return body.v + cross(body.w, at - reference); }
  // Upper bound of the speed that the pull adds within this radius of a point of the body.
  double pulled_by(const Vec3& at, double radius) const {
    if (!pulled) return 0.0;
    return norm(pull.v + cross(pull.w, at - reference)) + radius * norm(pull.w);
  }
  // Upper bound of the displacement of the collider by the step's rotation about its centre.
  double rotated(const Collider& collider, double dt) const {
    if (collider.geometry.kind == collide::Kind::sphere) return 0.0;
    const double rotation = dt * (pulled ? norm(body.w) + norm(pull.w) : norm(body.w));
    return collider.radius * std::min(rotation, 2.0);
  }
};

}  // namespace

double Approach::of(const Collider& a, const Collider& b) const {
  const Body &body_a = bodies[a.body], &body_b = bodies[b.body];
  const Approaching by_a(body_a, pull_of(body_a)), by_b(body_b, pull_of(body_b));
  const Vicinity at = vicinity_of(bodies, a, b);
  const double coupled_speed = norm(by_b.velocity(at.centre) - by_a.velocity(at.centre)) +
                               at.radius * norm(body_b.w - body_a.w) +
                               by_a.pulled_by(at.centre, at.radius) +
                               by_b.pulled_by(at.centre, at.radius);
  const Vec3 end_a = body_a.T * a.centre, end_b = body_b.T * b.centre;
  const double independent_speed = norm(by_b.velocity(end_b) - by_a.velocity(end_a)) +
                                   by_a.pulled_by(end_a, 0.0) + by_b.pulled_by(end_b, 0.0);
  return std::min(dt * coupled_speed,
                  dt * independent_speed + by_a.rotated(a, dt) + by_b.rotated(b, dt));
}

collide::PairMargin Approach::margin(const Collider& a, const Collider& b, double largest,
                                     double at_rest) const {
  const Body &body_a = bodies[a.body], &body_b = bodies[b.body];
  if (!(pull_of(body_a) == Velocity{} && pull_of(body_b) == Velocity{}))
    return collide::PairMargin(largest);
  const double slack = at_rest + pushed(a, b);
  if (slack >= largest) return collide::PairMargin(largest);
  return {largest, slack, motion(a, b, 0.0), {a.geometry, a.T}, {b.geometry, b.T}};
}

namespace {

// A bounding sphere that the body's rotation does not move.
struct SteadySphere {
  Vec3 centre, velocity;
  double radius;

  SteadySphere(const Body& body, const Collider& collider) {
    const Vec3 at = body.T * collider.centre;
    if (body.motion == Motion::fixed) {
      centre = at;
      radius = collider.radius;
      return;
    }
    centre = reference_point(body);
    velocity = body.v;
    radius = norm(at - centre) + collider.radius;
  }
};

}  // namespace

std::optional<Apart> Approach::spheres_apart(const Collider& a, const Collider& b,
                                             double slack) const {
  const Body &body_a = bodies[a.body], &body_b = bodies[b.body];
  const SteadySphere of_a(body_a, a), of_b(body_b, b);
  const double radii = of_a.radius + of_b.radius;
  const Vec3 between = of_b.centre - of_a.centre, motion = dt * (of_b.velocity - of_a.velocity);
  const double length2 = dot(motion, motion);
  const double nearest =
      length2 > 0.0 ? std::clamp(-dot(between, motion) / length2, 0.0, 1.0) : 0.0;
  const Vec3 then = between + nearest * motion;
  const double distance = norm(then);
  if (!(distance > radii + slack + pushed_by_others(body_a) + pushed_by_others(body_b)) ||
      !(pull_of(body_a) == Velocity{} && pull_of(body_b) == Velocity{}))
    return std::nullopt;
  const Vec3 n = (1.0 / distance) * then;
  return Apart{n, dot(n, between) - radii};
}

double Approach::pushed(const Collider& a, const Collider& b) const {
  const Body &body_a = bodies[a.body], &body_b = bodies[b.body];
  return pushed_by_others(body_a) + pushed_by_others(body_b) + moved_by_tumbling(body_a, dt) +
         moved_by_tumbling(body_b, dt);
}

collide::PairMotion Approach::motion(const Collider& a, const Collider& b, double tolerance) const {
  const auto of_body = [](const Body& body) {
    return collide::Motion{reference_point(body), body.v, body.w};
  };
  return {of_body(bodies[a.body]), of_body(bodies[b.body]), dt, tolerance};
}

}  // namespace vp
