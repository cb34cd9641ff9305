// Effects of the impulses of contact rows and joint rows on their bodies.
#pragma once

#include <algorithm>
#include <cmath>

#include "solve/contact_solver.h"
#include "solve/link_rows.h"

namespace vp::solve {

// The iteration ends when changes of speed are below this [m/s]: a twenty-thousandth of the speed
// that gravity adds in the step, but at least the rounding error.
inline double convergence_tolerance(const StepContext& s) {
  return std::max(1e-7, 5e-4 * s.step);
}

// Relative velocity without the articulations' changes: links have their velocities from before the
// solve.
inline Vec3 relative_velocity(const SolverBody& a, const SolverBody& b, const ContactConstraint& c,
                              const ContactPoint& p) {
  Vec3 u;
  if (!c.stands_b) u = b.v + cross(b.w, p.arm_b);
  if (!c.stands_a) u = u - a.v - cross(a.w, p.arm_a);
  return u;
}
// The relative speeds along the normal and the tangents.
struct PointSpeeds {
  double along[3];
};
inline PointSpeeds speeds_of(const SolverBody& a, const SolverBody& b, const ContactConstraint& c,
                             const ContactPoint& p) {
  const Vec3 u = relative_velocity(a, b, c, p);
  return {{dot(c.normal, u), dot(c.tangent[0], u), dot(c.tangent[1], u)}};
}
// The speed that the solve has added to a row through articulations.
inline double through_links(const ContactConstraint& c, int row) {
  if (!c.has_links()) return 0.0;
  return along(c.side_a, row, c.side_a.velocity) + along(c.side_b, row, c.side_b.velocity);
}

// Updates the friction impulse at tangential speeds u0 and u1 relative to the surfaces' own motion.
// Sticking: the full tangent block stops the point. Sliding: a gradient step with one mass for both
// directions, projected on the disc. Only one mass makes friction converge opposite to the
// velocity, since the block rotates the vector that it multiplies.
inline void friction_after(const ContactConstraint& c, const ContactPoint& p, double u0, double u1,
                           double normal_impulse, double (&impulse)[2]) {
  const double before0 = impulse[0], before1 = impulse[1];
  impulse[0] = before0 - (p.tangent_mass[0] * u0 + p.tangent_mass[1] * u1);
  impulse[1] = before1 - (p.tangent_mass[1] * u0 + p.tangent_mass[2] * u1);
  const double limit = c.friction * normal_impulse;
  if (impulse[0] * impulse[0] + impulse[1] * impulse[1] <= limit * limit) return;
  impulse[0] = before0 - p.slide_mass * u0;
  impulse[1] = before1 - p.slide_mass * u1;
  const double size = std::sqrt(impulse[0] * impulse[0] + impulse[1] * impulse[1]);
  if (size <= limit) return;
  impulse[0] *= limit / size;
  impulse[1] *= limit / size;
}
// The next rolling impulse at the relative angular velocity `rotation` of a contact with the normal
// load `load`.
inline Vec3 rolling_after(const ContactConstraint& c, const Vec3& before, const Vec3& rotation,
                          double load) {
  const Vec3 next = before - c.rolling_mass * rotation;
  const double limit = c.rolling * load, size = norm(next);
  return size > limit ? (limit / size) * next : next;
}

inline void apply(SolverBody& a, SolverBody& b, const ContactConstraint& c, const ContactPoint& p,
                  const Vec3& impulse) {
  if (c.moves_a) {
    a.v -= a.inverse_mass * impulse;
    a.w -= a.angular * cross(p.arm_a, impulse);
  }
  if (c.moves_b) {
    b.v += b.inverse_mass * impulse;
    b.w += b.angular * cross(p.arm_b, impulse);
  }
}
inline void apply_to_links(const ContactConstraint& c, int row, double impulse) {
  apply_impulse(c.side_a, row, impulse, c.side_a.velocity);
  apply_impulse(c.side_b, row, impulse, c.side_b.velocity);
}

// --- rows of joints

// The quantity that is read and changed: velocities, or the position correction.
struct Moved {
  Vec3 SolverBody::*linear;
  Vec3 SolverBody::*angular;
  double* LinkSide::*tree;
};
inline constexpr Moved kVelocity{&SolverBody::v, &SolverBody::w, &LinkSide::velocity};
inline constexpr Moved kShift{&SolverBody::shift, &SolverBody::rotation, &LinkSide::shift};

inline double speed_of(const StepContext& s, const JointPair& pair, const Moved& moved) {
  double speed = 0.0;
  for (const PairEnd* end : {&pair.a, &pair.b}) {
    const SolverBody& body = s.bodies[end->body];
    speed += dot(end->linear, body.*moved.linear) + dot(end->angular, body.*moved.angular) +
             along(end->side, 0, end->side.*moved.tree);
  }
  return speed;
}
inline void give(const StepContext& s, const JointPair& pair, double impulse, const Moved& moved) {
  for (const PairEnd* end : {&pair.a, &pair.b}) {
    apply_impulse(end->side, 0, impulse, end->side.*moved.tree);
    if (!end->moves) continue;
    SolverBody& body = s.bodies[end->body];
    body.*moved.linear += (body.inverse_mass * impulse) * end->linear;
    body.*moved.angular += body.angular * (impulse * end->angular);
  }
}

inline double speed_of(const StepContext& s, const JointRow& row) {
  if (row.pair == kNoPair) return row.speed + along(row.side, 0, row.side.velocity);
  return speed_of(s, s.pairs[row.pair], kVelocity);
}
inline void give(const StepContext& s, const JointRow& row, double impulse) {
  if (row.pair == kNoPair) return apply_impulse(row.side, 0, impulse, row.side.velocity);
  give(s, s.pairs[row.pair], impulse, kVelocity);
}
// Returns the change of the row's speed.
inline double solve_joint(const StepContext& s, JointRow& row) {
  const double next = impulse_after(row, row.impulse, speed_of(s, row));
  const double change = next - row.impulse;
  row.impulse = next;
  give(s, row, change);
  return row.inverse_mass * std::fabs(change);
}

inline void apply_moment(SolverBody& a, SolverBody& b, const ContactConstraint& c,
                         const Vec3& impulse) {
  if (c.moves_a) a.w -= a.angular * impulse;
  if (c.moves_b) b.w += b.angular * impulse;
  if (!c.has_links()) return;
  for (int i = 0; i < 3; ++i) apply_to_links(c, row_of(c.count, i), impulse[i]);
}

}  // namespace vp::solve
