#include "world/link_contacts.h"

#include <algorithm>
#include <utility>

#include "solve/state_vector.h"
#include "world/joint_steps.h"
#include "world/validate.h"

namespace vp {

void LinkContacts::begin_step(std::size_t contacts) {
  if (!empty()) {
    is_empty_ = true;
    for (const std::uint32_t i : bodies_) s_.bodies[i].on_link = false;
    for (Articulation& art : s_.articulations) art.sub_stepped = false;
    bodies_.clear();
  }
  if (s_.articulations.empty() || (forced_.size() == s_.bodies.size() && contacts <= reserved_))
    return;
  bodies_.reserve(s_.bodies.size());
  forced_.resize(s_.bodies.size());
  contacts_.reserve(contacts);
  pairs_.reserve(contacts);
  reserved_ = std::max(contacts, reserved_);
}

// Finds the bodies near links, and the articulations that take part: those near a body, and those
// that touch them.
void LinkContacts::find_bodies() {
  if (s_.articulations.empty()) return;
  const auto articulation_of = [this](const Body& body) {
    return body.is_link ? &s_.articulations[body.articulation] : nullptr;
  };
  find_joined_bodies();
  const auto touches_link = [](const Contact& c) { return c.alive && c.of_link && !c.sensor; };
  for (const Contact& c : s_.contact_store.pool) {
    if (!touches_link(c)) continue;
    for (const auto& [mine, other] : {std::pair{c.a, c.b}, std::pair{c.b, c.a}}) {
      Articulation* art = articulation_of(s_.bodies[s_.colliders[other].body]);
      const std::uint32_t index = s_.colliders[mine].body;
      const Body& body = s_.bodies[index];
      if (!art || !joins_sub_steps(body) || body.motion != Motion::dynamic) continue;
      put_on_link(index, *art);
    }
  }
  bool again = !empty();
  const auto join = [&](const Body& body_a, const Body& body_b) {
    Articulation *a = articulation_of(body_a), *b = articulation_of(body_b);
    if (!a || !b || a->sub_stepped == b->sub_stepped) return;
    a->sub_stepped = b->sub_stepped = again = true;
  };
  while (again) {
    again = false;
    for (const Contact& c : s_.contact_store.pool) {
      if (!touches_link(c)) continue;
      join(s_.bodies[s_.colliders[c.a].body], s_.bodies[s_.colliders[c.b].body]);
    }
    for (const std::uint32_t i : rows_.joints())
      join(s_.bodies[s_.joints[i].a], s_.bodies[s_.joints[i].b]);
  }
}

// Those with colliders stay in the impact stage, which finds their contacts again at each impact;
// in the sub-steps, links that rotate far would pass through what they meet.
void LinkContacts::find_fast(double dt) {
  const auto has_collider = [this](std::uint32_t body) {
    return s_.bodies[body].first_collider != kNone;
  };
  const auto is_joined = [this](std::uint32_t body) {
    return s_.bodies[body].first_joint != kNone;
  };
  for (Articulation& art : s_.articulations) {
    if (!art.alive || art.remote || art.sub_stepped || s_.bodies[art.bodies.front()].asleep)
      continue;
    if (std::any_of(art.bodies.begin(), art.bodies.end(), has_collider) ||
        std::any_of(art.bodies.begin(), art.bodies.end(), is_joined) || !art.turns_far(dt))
      continue;
    art.sub_stepped = true;
    is_empty_ = false;
  }
}

void LinkContacts::find_joined_bodies() {
  for (const std::uint32_t i : rows_.joints()) {
    const BodyJoint& joint = s_.joints[i];
    for (const auto& [link, other] : {std::pair{joint.a, joint.b}, std::pair{joint.b, joint.a}}) {
      const Body& body = s_.bodies[other];
      if (!s_.bodies[link].is_link || !joins_sub_steps(body) || body.motion != Motion::dynamic)
        continue;
      put_on_link(other, s_.articulations[s_.bodies[link].articulation]);
    }
  }
}

void LinkContacts::put_on_link(std::uint32_t index, Articulation& art) {
  art.sub_stepped = true;
  is_empty_ = false;
  Body& body = s_.bodies[index];
  if (body.on_link) return;
  body.on_link = true;
  wake(s_, index);
  bodies_.push_back(index);
}

void LinkContacts::begin_sub_steps(double dt, int sub_steps) {
  std::fill(forced_.begin(), forced_.end(), Velocity{});
  pairs_.clear();
  for (const Contact& c : s_.contact_store.pool) {
    if (!c.alive || !c.of_link || c.sensor) continue;
    const Body &a = s_.bodies[s_.colliders[c.a].body], &b = s_.bodies[s_.colliders[c.b].body];
    if (in_sub_steps(s_.articulations, a, b) && !a.continuous && !b.continuous &&
        !disables_collision(s_.bodies, s_.joints, s_.colliders[c.a].body, s_.colliders[c.b].body)) {
      pairs_.push_back({c.key, c.a, c.b});
    }
  }
  std::sort(pairs_.begin(), pairs_.end(),
            [](const ColliderPair& p, const ColliderPair& q) { return p.key < q.key; });
  contacts_.clear();
  for (const ColliderPair& pair : pairs_) {
    const std::uint32_t i = s_.colliders[pair.a].body, j = s_.colliders[pair.b].body;
    pose_colliders(s_.bodies[i], s_.colliders);
    pose_colliders(s_.bodies[j], s_.colliders);
    const double approach_speed = s_.approach_in(dt).of(s_.colliders[pair.a], s_.colliders[pair.b]);
    pair_contacts_.add(pair, 2.0 * s_.desc.contact_slop + approach_speed, false, true, contacts_);
  }
  // The stored impulses are those of a whole step.
  const double fraction = 1.0 / sub_steps;
  for (solve::ContactConstraint& c : contacts_) {
    c.rolling_impulse *= fraction;
    for (int i = 0; i < c.count; ++i) {
      c.points[i].normal_impulse *= fraction;
      for (double& p : c.points[i].tangent_impulse) p *= fraction;
    }
  }
  for (Articulation& art : s_.articulations) {
    if (art.sub_stepped) art.mark_start();
  }
}

solve::StepContext LinkContacts::context(double h) {
  solve::StepContext context = rows_.context(contacts_, h, h);
  context.bias_rate = kUseBias / h;
  context.max_bias_velocity = kMaxCorrectionSpeed * s_.speed_unit;
  return context;
}
RowJointStep LinkContacts::row_joint_step(double h) const {
  return {RowsOf::sub_step, h, h, h / s_.dt, s_.speed_unit};
}

// Loads the velocities that the contact blocks and joints have computed.
void LinkContacts::load_bodies() {
  for (const std::uint32_t i : bodies_) {
    rows_.body(i).v = vector_of(s_.body_states[i + 1].velocity);
    rows_.body(i).w = vector_of(s_.body_states[i + 1].velocity + 3);
  }
}
void LinkContacts::store_bodies() {
  for (const std::uint32_t i : bodies_) {
    put(s_.body_states[i + 1].velocity, rows_.body(i).v);
    put(s_.body_states[i + 1].velocity + 3, rows_.body(i).w);
  }
}

void LinkContacts::begin_sub_step(double h) {
  for (std::uint32_t a = 0; a < s_.articulations.size(); ++a) {
    Articulation& art = s_.articulations[a];
    if (!art.sub_stepped) continue;
    for (const std::uint32_t b : art.bodies) forced_[b] = {s_.bodies[b].w, s_.bodies[b].v};
    bool changed = false;
    if (!art.integrate_forces(h, changed)) {
      s_.status.non_finite = true;
      art.return_to_start();
    }
    follow_velocities(art, s_.bodies);
    for (const std::uint32_t b : art.bodies) {
      forced_[b] = {s_.bodies[b].w - forced_[b].w, s_.bodies[b].v - forced_[b].v};
    }
    rows_.load_articulation(a, true);
  }
  rows_.add_rows(row_joint_step(h));
  for (const solve::ContactConstraint& c : contacts_) {
    for (const std::uint32_t i : {c.a, c.b}) load_body(i, h);
  }
  for (const solve::JointPair& pair : rows_.pairs()) {
    for (const std::uint32_t i : {pair.a.body, pair.b.body}) load_body(i, h);
  }
  load_bodies();
  solve::begin_sub_step(context(h));
  store_bodies();
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
void LinkContacts::load_body(std::uint32_t index, double h) {
  const Body& body = s_.bodies[index];
  const bool stands = body.is_link || body.motion == Motion::fixed;
  const Vec3 at =
      stands
          ? reference_point(body)
          : pose_within_step(body, s_.body_states[index + 1], s_.start_displacements[index]).centre;
  solve::SolverBody& s = rows_.load_body(index, at, body.is_link ? forced_[index] : Velocity{});
  if (body.is_link) {
    s.articulation = static_cast<int>(body.articulation);
    s.link = body.link;
    return;
  }
  s.in_blocks = body.contact_slots > 0 || has_block_joints(body, s_.joints);
  if (body.motion != Motion::dynamic) return;
  const Velocity a = s_.acceleration_of(body);
  s.forced_w = h * a.w;
  s.forced_v = h * a.v;
}

void LinkContacts::iterate(double h) {
  load_bodies();
  solve::solve_sub_step(context(h));
  store_bodies();
}

void LinkContacts::move(double h) {
  load_bodies();
  for (Articulation& art : s_.articulations) {
    if (art.sub_stepped) art.store_sub_step_velocity();
  }
  solve::advance_contacts(context(h), h);
}

void LinkContacts::relax(double h) {
  load_bodies();
  solve::relax_sub_step(context(h));
  store_bodies();
  solve::note_sub_step(contacts_);
  rows_.note_link_impulses(contacts_);
  for (const solve::ContactConstraint& c : contacts_) {
    if (c.points[0].normal_impulse <= 0.0) continue;
    for (const std::uint32_t i : {c.a, c.b})
      s_.body_states[i + 1].displacement[solve::kSupported] = 1.0f;
  }
  for (const solve::JointRow& row : rows_.rows()) {
    if (row.remember) *row.remember = s_.dt / h * row.impulse;  // of a whole step
    if (row.pair == solve::kNoPair)
      s_.articulations[row.articulation].add_effort(row.dof, row.impulse);
  }
  rows_.take_back_joints(row_joint_step(h));
  for (Articulation& art : s_.articulations) {
    if (!art.sub_stepped) continue;
    (void)art.end_solve();
    art.advance_sub_step(h);
    if (!stop_if_out_of_range(s_, art)) follow(art, s_.bodies, s_.lists);
  }
}

// Events, impulses for the next step's warm start, and the articulations' mean motion.
void LinkContacts::end_sub_steps(double dt, int sub_steps, std::span<Velocity> drift) {
  if (empty()) return;
  pair_contacts_.remember(contacts_, sub_steps);
  for (solve::ContactConstraint& c : contacts_) {
    for (int i = 0; i < c.count; ++i) {
      solve::ContactPoint& p = c.points[i];
      const double last = p.normal_impulse;
      for (double& q : p.tangent_impulse) q *= last > 0.0 ? p.step_impulse / last : 0.0;
      p.normal_impulse = p.step_impulse;
      p.approach = p.step_approach;
      p.hits = p.step_hits;
    }
    s_.counters.contacts += static_cast<std::uint32_t>(c.count);
  }
  pair_contacts_.report(contacts_, 0.0);
  for (Articulation& art : s_.articulations) {
    if (!art.sub_stepped) continue;
    art.end_sub_steps(dt);
    for (const std::uint32_t b : art.bodies) {
      const se3 more =
          art.drift_of(s_.bodies[b].link, art.T_world_link(s_.bodies[b].link).position());
      drift[b] = {more.w, more.v};
    }
    art.refresh();
    follow(art, s_.bodies, s_.lists);
  }
}

}  // namespace vp
