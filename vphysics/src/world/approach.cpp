#include "world/approach.h"

#include <algorithm>

#include "world/solver_limits.h"

namespace vp {
namespace {

// An acceleration that the margins allow for [m/s^2], a few times that of gravity: what it adds to
// the displacement of a step is found in the next step. Margins include what a stronger one adds.
constexpr double kBornePull = 50.0;

}  // namespace

Velocity Approach::pull_of(const Body& body) const {
  if (body.motion != Motion::dynamic || body.is_link || body.asleep) return {};
  const Velocity a = loads.acceleration(body, desc.gravity);
  if (body.load == kNone && dot(a.v, a.v) <= kBornePull * kBornePull) return {};
  const double max_value = norm(a.v) + body.bounding_radius * norm(a.w);
  if (max_value <= kBornePull || dt * dt * max_value <= desc.contact_slop) return {};
  const double mean = 0.5 * dt * (1.0 + 1.0 / sub_steps_in(desc, speed_unit, dt));
  return {mean * a.w, mean * a.v};
}

double Approach::of(const Collider& a, const Collider& b) const {
  const Body &body_a = bodies[a.body], &body_b = bodies[b.body];
  const auto velocity = [&](const Body& body, const Vec3& at) {
    return body.v + cross(body.w, at - reference_point(body));
  };
  const Velocity pull_a = pull_of(body_a), pull_b = pull_of(body_b);
  // Speed from the pull within a radius of a point of the body.
  const auto pulled = [&](const Body& body, const Velocity& pull, const Vec3& at, double radius) {
    if (pull == Velocity{}) return 0.0;
    return norm(pull.v + cross(pull.w, at - reference_point(body))) + radius * norm(pull.w);
  };
  const Vicinity at = vicinity_of(bodies, a, b);
  const double together = norm(velocity(body_b, at.centre) - velocity(body_a, at.centre)) +
                          at.radius * norm(body_b.w - body_a.w) +
                          pulled(body_a, pull_a, at.centre, at.radius) +
                          pulled(body_b, pull_b, at.centre, at.radius);
  const auto rotated = [&](const Collider& c, const Body& body, const Velocity& pull) {
    const double rotation = dt * (norm(body.w) + norm(pull.w));
    return c.geometry.kind == collide::Kind::sphere ? 0.0 : c.radius * std::min(rotation, 2.0);
  };
  const Vec3 end_a = body_a.T * a.centre, end_b = body_b.T * b.centre;
  const double separation = norm(velocity(body_b, end_b) - velocity(body_a, end_a)) +
                            pulled(body_a, pull_a, end_a, 0.0) + pulled(body_b, pull_b, end_b, 0.0);
  return std::min(dt * together,
                  dt * separation + rotated(a, body_a, pull_a) + rotated(b, body_b, pull_b));
}

}  // namespace vp
