#include "solve/link_rows.h"

namespace vp::solve {
namespace {

// Everything but the rows themselves.
void attach(const SolverArticulation& art, std::uint32_t first, std::uint32_t depth,
            LinkSide& side) {
  side = {nullptr, art.factor->next(), art.velocity, art.shift, first, depth};
}

std::size_t attach(const StepContext& s, const ContactConstraint& c, std::uint32_t body,
                   LinkSide& side) {
  side = {};
  const SolverBody& link = s.bodies[body];
  if (link.articulation < 0) return 0;
  SolverArticulation& art = s.articulations[static_cast<std::size_t>(link.articulation)];
  // What touches a link that is fixed to the world moves none of its joints.
  art.touched = art.touched || art.factor->depth(link.link) > 0;
  attach(art, art.factor->first(link.link), art.factor->depth(link.link), side);
  return static_cast<std::size_t>(rows_of(c)) * side.depth;
}

// The rows of one side; its impulses are those of the other one turned round.
double* fill(const StepContext& s, const ContactConstraint& c, std::uint32_t body, double sign,
             LinkSide& side, double* y) {
  if (side.depth == 0) return y;
  const SolverBody& link = s.bodies[body];
  const detail::ImpulseFactor& factor =
      *s.articulations[static_cast<std::size_t>(link.articulation)].factor;
  side.rows = y;
  for (int i = 0; i < c.count; ++i) {
    for (const Vec3* d : {&c.normal, &c.tangent[0], &c.tangent[1]}) {
      factor.force_row(link.link, c.points[i].position, sign * *d, y);
      y += side.depth;
    }
  }
  if (c.rolling > 0.0) {
    for (const Vec3& d : {Vec3{1, 0, 0}, Vec3{0, 1, 0}, Vec3{0, 0, 1}}) {
      factor.moment_row(link.link, sign * d, y);
      y += side.depth;
    }
  }
  return y;
}

}  // namespace

void prepare_link_rows(const StepContext& s) {
  std::size_t size = 0;
  for (ContactConstraint& c : s.contacts) {
    size += attach(s, c, c.a, c.side_a) + attach(s, c, c.b, c.side_b);
  }
  if (s.rows.size() < size) s.rows.resize(size);
  double* y = s.rows.data();
  for (ContactConstraint& c : s.contacts) {
    y = fill(s, c, c.a, -1.0, c.side_a, y);
    y = fill(s, c, c.b, 1.0, c.side_b, y);
  }
  for (JointRow& row : s.joints) {
    const SolverArticulation& art = s.articulations[row.articulation];
    const detail::ImpulseFactor::JointRow of = art.factor->joint_row(row.dof);
    attach(art, row.dof, art.factor->depth_of_dof(row.dof), row.side);
    row.side.rows = of.y;
    row.inverse_mass = of.response;
    row.mass = 1.0 / (of.response + row.softness);
  }
}

}  // namespace vp::solve
