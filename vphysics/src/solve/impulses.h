// What the impulses of a contact's rows do to its bodies.
#pragma once

#include "solve/contact_solver.h"
#include "solve/link_rows.h"

namespace vp::solve {

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
  push(c.side_a, row, impulse, c.side_a.velocity);
  push(c.side_b, row, impulse, c.side_b.velocity);
}

inline void apply_moment(SolverBody& a, SolverBody& b, const ContactConstraint& c,
                         const Vec3& impulse) {
  if (c.moves_a) a.w -= a.angular * impulse;
  if (c.moves_b) b.w += b.angular * impulse;
  if (!c.has_links()) return;
  for (int i = 0; i < 3; ++i) apply_to_links(c, row_of(c.count, i), impulse[i]);
}

}  // namespace vp::solve
