// Contacts between links and sub-stepped bodies, in the sub-steps.
//
// An articulation that supports a body takes part in the sub-steps, together with everything that
// it touches. In each sub-step its forces are integrated; its joint rows and contacts are solved in
// iterations, alternating with the contact blocks and the joints of bodies; and it moves. It
// responds to impulses through its own joints (solve/link_side.h), so no joint separates under a
// load. Afterwards it returns to its pose at the start of the step. The impact stage then moves
// it, with everything else, along its mean velocities, so that swept bodies collide with it on its
// path.
//
// An articulation without such a body nearby is left to the impact stage, with its contacts.
#include <algorithm>

#include "solve/row_vector.h"
#include "world/impl.h"
#include "world/validate.h"

namespace vp {

// Finds the bodies near links, and the articulations that take part: those near a body, and those
// that touch them.
void World::Impl::find_bodies_on_links() {
  if (articulations.empty()) return;
  const auto articulation_of = [this](const Body& body) {
    return body.is_link ? &articulations[body.articulation] : nullptr;
  };
  find_bodies_joined_to_links();
  const auto touches_link = [](const Contact& c) { return c.alive && c.of_link && !c.sensor; };
  for (const Contact& c : contact_store.pool) {
    if (!touches_link(c)) continue;
    for (const auto& [mine, other] : {std::pair{c.a, c.b}, std::pair{c.b, c.a}}) {
      Articulation* art = articulation_of(bodies[colliders[other].body]);
      const std::uint32_t index = colliders[mine].body;
      const Body& body = bodies[index];
      if (!art || !joins_sub_steps(body) || body.motion != Motion::dynamic) continue;
      put_on_link(index, *art);
    }
  }
  bool again = !impacts.bodies_on_links.empty();
  const auto join = [&](const Body& body_a, const Body& body_b) {
    Articulation *a = articulation_of(body_a), *b = articulation_of(body_b);
    if (!a || !b || a->sub_stepped == b->sub_stepped) return;
    a->sub_stepped = b->sub_stepped = again = true;
  };
  while (again) {
    again = false;
    for (const Contact& c : contact_store.pool) {
      if (!touches_link(c)) continue;
      join(bodies[colliders[c.a].body], bodies[colliders[c.b].body]);
    }
    for (const std::uint32_t i : impacts.row_joints) join(bodies[joints[i].a], bodies[joints[i].b]);
  }
}

void World::Impl::put_on_link(std::uint32_t index, Articulation& art) {
  art.sub_stepped = true;
  Body& body = bodies[index];
  if (body.on_link) return;
  body.on_link = true;
  wake(index);
  impacts.bodies_on_links.push_back(index);
}

void World::Impl::find_link_contacts(double dt, int sub_steps) {
  impacts.discrete_pairs.clear();
  for (const Contact& c : contact_store.pool) {
    if (!c.alive || !c.of_link || c.sensor) continue;
    const Body &a = bodies[colliders[c.a].body], &b = bodies[colliders[c.b].body];
    if (in_sub_steps(articulations, a, b) && !a.continuous && !b.continuous &&
        !disables_collision(bodies, joints, colliders[c.a].body, colliders[c.b].body)) {
      impacts.discrete_pairs.push_back({c.key, c.a, c.b});
    }
  }
  std::sort(impacts.discrete_pairs.begin(), impacts.discrete_pairs.end(),
            [](const ColliderPair& p, const ColliderPair& q) { return p.key < q.key; });
  impacts.link_contacts.clear();
  for (const ColliderPair& pair : impacts.discrete_pairs) {
    const std::uint32_t i = colliders[pair.a].body, j = colliders[pair.b].body;
    pose_colliders(bodies[i], colliders);
    pose_colliders(bodies[j], colliders);
    const double approach_speed = context.approach_in(dt).of(colliders[pair.a], colliders[pair.b]);
    std::uint32_t part = 0;
    for (const auto& found : manifolds_of(pair, 2.0 * desc.contact_slop + approach_speed)) {
      add_contact(pair, found.manifold, part++, false, true, impacts.link_contacts);
    }
  }
  // The stored impulses are those of a whole step.
  const double fraction = 1.0 / sub_steps;
  for (solve::ContactConstraint& c : impacts.link_contacts) {
    c.rolling_impulse *= fraction;
    for (int i = 0; i < c.count; ++i) {
      c.points[i].normal_impulse *= fraction;
      for (double& p : c.points[i].tangent_impulse) p *= fraction;
    }
  }
  for (Articulation& art : articulations) {
    if (art.sub_stepped) art.mark_start();
  }
}

solve::StepContext World::Impl::link_context(double h) {
  return {impacts.solver_bodies,
          impacts.link_contacts,
          impacts.joint_rows,
          impacts.joint_pairs,
          impacts.solver_articulations,
          impacts.link_rows,
          impacts.instant,
          h,
          h,
          desc.contact_slop,
          desc.restitution_threshold,
          desc.velocity_iterations,
          kUseBias / h,
          kMaxCorrectionSpeed * speed_unit};
}

// Loads the velocities that the contact blocks and joints have computed.
void World::Impl::load_bodies_on_links() {
  for (const std::uint32_t i : impacts.bodies_on_links) {
    impacts.solver_bodies[i].v = vector_of(body_rows[i + 1].velocity);
    impacts.solver_bodies[i].w = vector_of(body_rows[i + 1].velocity + 3);
  }
}
void World::Impl::store_bodies_on_links() {
  for (const std::uint32_t i : impacts.bodies_on_links) {
    put(body_rows[i + 1].velocity, impacts.solver_bodies[i].v);
    put(body_rows[i + 1].velocity + 3, impacts.solver_bodies[i].w);
  }
}

// Integrates the forces of the sub-step and prepares the solver's data.
void World::Impl::begin_links(double h) {
  for (std::size_t a = 0; a < articulations.size(); ++a) {
    Articulation& art = articulations[a];
    if (!art.sub_stepped) continue;
    for (const std::uint32_t b : art.bodies) impacts.forced[b] = {bodies[b].w, bodies[b].v};
    bool changed = false;
    if (!art.integrate_forces(h, changed)) {
      status.non_finite = true;
      art.return_to_start();
    }
    follow_velocities(art, bodies);
    for (const std::uint32_t b : art.bodies) {
      impacts.forced[b] = {bodies[b].w - impacts.forced[b].w, bodies[b].v - impacts.forced[b].v};
    }
    impacts.solver_articulations[a] = art.begin_solve(true);
  }
  add_joint_rows(h, h, RowsOf::sub_step);
  for (const solve::ContactConstraint& c : impacts.link_contacts) {
    for (const std::uint32_t i : {c.a, c.b})
      impacts.solver_bodies[i] = solver_body_in_sub_step(i, h);
  }
  add_row_joints({RowsOf::sub_step, h, h, h / dt_now, speed_unit});
  for (const solve::JointPair& pair : impacts.joint_pairs) {
    for (const std::uint32_t i : {pair.a.body, pair.b.body})
      impacts.solver_bodies[i] = solver_body_in_sub_step(i, h);
  }
  load_bodies_on_links();
  solve::begin_sub_step(link_context(h));
  store_bodies_on_links();
}

namespace {

bool has_block_joints(const Body& body, const Joints& joints) {
  for (std::uint32_t e = body.first_joint; e != kNone; e = joints[e / 2].next[e % 2]) {
    if (!joints[e / 2].in_rows) return true;
  }
  return false;
}

}  // namespace

// The body at its pose in this sub-step. A fixed link is also solved with its articulation's
// joints.
solve::SolverBody World::Impl::solver_body_in_sub_step(std::uint32_t index, double h) const {
  const Body& body = bodies[index];
  const bool stands = body.is_link || body.motion == Motion::fixed;
  const Vec3 at =
      stands ? reference_point(body)
             : pose_within_step(body, body_rows[index + 1], sub_step.start_displacements[index])
                   .centre;
  solve::SolverBody s = solver_body(index, at);
  if (body.is_link) {
    s.articulation = static_cast<int>(body.articulation);
    s.link = body.link;
  } else {
    s.forced_w = s.forced_v = {};
    s.in_blocks = body.lanes > 0 || has_block_joints(body, joints);
    if (body.motion == Motion::dynamic) {
      const Velocity a = context.acceleration_of(body);
      s.forced_w = h * a.w;
      s.forced_v = h * a.v;
    }
  }
  return s;
}

void World::Impl::solve_links(double h) {
  load_bodies_on_links();
  solve::solve_sub_step(link_context(h));
  store_bodies_on_links();
}

// Advances the contacts' separations with their bodies. The articulations are not relaxed yet.
void World::Impl::move_links(double h) {
  load_bodies_on_links();
  for (Articulation& art : articulations) {
    if (art.sub_stepped) art.store_sub_step_velocity();
  }
  solve::advance_contacts(link_context(h), h);
}

void World::Impl::relax_links(double h) {
  load_bodies_on_links();
  solve::relax_sub_step(link_context(h));
  store_bodies_on_links();
  solve::note_sub_step(impacts.link_contacts);
  note_link_impulses(impacts.link_contacts);
  for (const solve::ContactConstraint& c : impacts.link_contacts) {
    if (c.points[0].normal_impulse <= 0.0) continue;
    for (const std::uint32_t i : {c.a, c.b}) body_rows[i + 1].displacement[solve::kCarried] = 1.0f;
  }
  for (solve::JointRow& row : impacts.joint_rows) {
    if (row.remember) *row.remember = dt_now / h * row.impulse;  // of a whole step
    if (row.pair == solve::kNoPair)
      articulations[row.articulation].add_effort(row.dof, row.impulse);
  }
  take_back_row_joints({RowsOf::sub_step, h, h, h / dt_now, speed_unit});
  for (Articulation& art : articulations) {
    if (!art.sub_stepped) continue;
    (void)art.end_solve();
    art.advance_sub_step(h);
    if (!stop_if_out_of_range(context, art)) follow(art);
  }
}

// Events, impulses for the next step's warm start, and the articulations' mean motion.
void World::Impl::end_links(double dt, int sub_steps) {
  if (impacts.bodies_on_links.empty()) return;
  remember_impulses(impacts.link_contacts, sub_steps);
  for (solve::ContactConstraint& c : impacts.link_contacts) {
    for (int i = 0; i < c.count; ++i) {
      solve::ContactPoint& p = c.points[i];
      const double last = p.normal_impulse;
      for (double& q : p.tangent_impulse) q *= last > 0.0 ? p.step_impulse / last : 0.0;
      p.normal_impulse = p.step_impulse;
      p.approach = p.step_approach;
      p.hits = p.step_hits;
    }
    counters.contacts += static_cast<std::uint32_t>(c.count);
  }
  report_contacts(impacts.link_contacts, 0.0);
  note_contacts(impacts.link_contacts);
  for (Articulation& art : articulations) {
    if (!art.sub_stepped) continue;
    art.end_sub_steps(dt);
    for (const std::uint32_t b : art.bodies) {
      const se3 more = art.drift_of(bodies[b].link, art.T_world_link(bodies[b].link).position());
      impacts.drift[b] = {more.w, more.v};
      impacts.forced[b] = {};
    }
    art.refresh();
    follow(art);
  }
}

}  // namespace vp
