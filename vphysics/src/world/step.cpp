// One step: forces, then contacts and impacts in the order of time.
//
//   integrate forces over dt
//   repeat   solve the current contacts
//            advance everything at constant twists to the next impact of a continuous body
//   until the end of the step; after max_impacts_per_step impacts, bodies that would collide stop
//
// See docs/decisions/0002-impacts-and-contacts.md.
#include <algorithm>
#include <cmath>
#include <utility>

#include "vphysics/recording.h"
#include "world/free_rotation.h"
#include "world/impl.h"
#include "world/invalid.h"
#include "world/validate.h"

namespace vp {

Expected<StepStatus> World::step(double dt) {
  if (!(dt >= kShortestStep && dt <= kLongestStep))
    return invalid("step: dt must be from 1e-7 to 0.1 seconds");
  if (impl_->dt_now > 0.0)
    return invalid(
        Errc::unsupported,
        "step: a step of this world is going on; call it when that has returned, not from an "
        "observer or a job");
  impl_->dt_now = dt;
  impl_->begin_step(dt);
  impl_->run(dt);
  impl_->finish_step();
  impl_->dt_now = 0.0;
  if (impl_->recorder) impl_->recorder->add_step(*this, dt);
  return impl_->status;
}

void World::Impl::begin_step(double dt) {
  const auto stage = in(Stage::prepare);
  ready_for_queries = false;
  const std::size_t n = bodies.size();
  status = {};
  position_error_now = false;
  counters = {};
  shapes.manifold_scratch.triangles_tested = 0;
  shapes.manifold_scratch.crowded = shapes.manifold_scratch.rough = false;
  events.clear();
  step_contacts.clear();
  impacts.next_records.clear();
  // Reserves capacity for a busy step, so that the first busy step does not allocate.
  const std::size_t capacity = 64 + 2 * colliders.size() + events.destroyed.size();
  events.reserve(capacity);
  impacts.records.reserve(capacity);
  impacts.next_records.reserve(capacity);
  contact_store.reserve(capacity);
  contact_search.begin_step(capacity);
  lost_bodies.reserve(n);
  sleep_islands.reserve(n);
  for (const std::uint32_t i : impacts.bodies_on_links) bodies[i].on_link = false;
  impacts.bodies_on_links.clear();
  for (Articulation& art : articulations) {
    art.sub_stepped = false;
    art.forget_step();
  }
  list_bodies();
  body_rows.resize(n + 1);
  contact_store.graph.resize(n + 1);
  divide_into_regions(dt);
  sub_step.blocks.words.reserve(capacity / solve::kLanes +
                                2 * solve::kColours * contact_store.graph.regions());
  if (!lists.awake_bodies.empty()) contact_store.graph.reserve(lists.awake_bodies.size());
  sub_step.start_displacements.resize(n);
  sub_step.velocity_changes.resize(n);
  sub_step.searched.resize(n);
  sub_step.fast_rotation.rotates_fast.reserve(n);
  sub_step.fast_rotation.shortened.reserve(64 + n / 8);  // grows if more bodies rotate fast
  impacts.row_joints.clear();
  if (has_impact_stage()) begin_impact_stage(dt);
  sub_step.joints.active.reserve(joints.size());
  events.report_destroyed(colliders);
  finds_contacts = contact_search.is_needed();
  if (lists.some_sub_stepped) load_rows(dt);
  if (finds_contacts) {
    for (const std::uint32_t i : lists.links) update_bounds(context, i, dt, false);
  }
}

void World::Impl::divide_into_regions(double dt) {
  const std::size_t before = regions.state.count;
  if (!regions.divide(bodies, lists.awake_bodies, static_cast<std::size_t>(desc.region_bodies), dt))
    return;
  contact_store.graph.set_regions(std::max<std::size_t>(before, regions.state.count) + 1);
  for (const std::uint32_t i : regions.changed()) contact_store.follow_region(bodies[i], body_set);
  contact_store.graph.set_regions(std::size_t{regions.state.count} + 1);
  regions.sort(bodies, lists.awake_bodies);
}

// Scales the warm-start impulses by the ratio of the step lengths.
void World::Impl::rescale_impacts(double dt) {
  const double before = std::exchange(impacts.step, dt);
  if (before == 0.0 || before == dt) return;
  const double scale = dt / before;
  const auto scaled = [scale](double x) { return in_range(scale * x) ? scale * x : 0.0; };
  for (PairRecord& record : impacts.records) {
    record.rolling *= scale;
    for (PairPoint& point : record.points) {
      point.normal_impulse *= scale;
      point.friction *= scale;
      if (!in_range(point.normal_impulse) || !in_range(point.friction)) {
        point.normal_impulse = 0.0;
        point.friction = {};
      }
    }
    if (!in_range(record.rolling)) record.rolling = {};
  }
  for (BodyJoint& joint : joints) {
    if (!joint.alive || !joint.in_rows) continue;
    for (BodyJointRow& row : joint.rows) {
      row.impulse = scaled(row.impulse);
      row.stop = scaled(row.stop);
    }
  }
  for (Articulation& art : articulations) {
    for (JointDof& dof : art.dofs) {
      for (double& impulse : dof.impulses) impulse = scaled(impulse);
    }
  }
}

void World::Impl::begin_impact_stage(double dt) {
  rescale_impacts(dt);
  list_row_joints();
  // More manifolds than a pair has, unless many parts of a compound touch at once. So a world's
  // first contact allocates nothing.
  constexpr std::size_t kManifoldsOfPair = 64;
  const std::size_t n = bodies.size(),
                    capacity = 64 + 2 * colliders.size() + events.destroyed.size();
  impacts.swept_body_pairs.reserve(n, capacity);
  impacts.discrete_body_pairs.reserve(n, capacity);
  impacts.discrete_pairs.reserve(capacity);
  impacts.swept_pairs.reserve(capacity);
  impacts.discrete_contacts.reserve(capacity);
  impacts.contacts.reserve(capacity);
  impacts.link_contacts.reserve(capacity);
  step_contacts.reserve(4 * capacity);
  shapes.manifolds.reserve(kManifoldsOfPair);
  std::size_t dofs = 0;
  for (const Articulation& art : articulations) dofs = std::max(dofs, art.dofs.size());
  impacts.instant.reserve(capacity, impacts.joint_rows.capacity(), dofs);
  impacts.bodies_on_links.reserve(n);
  impacts.bounds.resize(n);
  impacts.motions.resize(n);
  impacts.solver_bodies.resize(n);
  impacts.start_poses.resize(n);
  impacts.stopped.assign(n, 0);
  impacts.in_contact.assign(n, 0);
  impacts.moves_rigidly.assign(n, 0);
  impacts.brought.assign(n, 0);
  impacts.times.assign(n, 0.0);
  impacts.concerns.assign(n, Concern::none);
  impacts.first_impacts.resize(n);
  impacts.concerned.reserve(n);
  impacts.moved.reserve(n);
  impacts.queue.reserve(capacity);
  impacts.reached_sensors.reserve(capacity);
  if (impacts.scratch_is_dirty) {
    impacts.scratch_is_dirty = false;
    impacts.drift.assign(n, {});
    impacts.forced.assign(n, {});
  }
  for (const std::uint32_t i : lists.of_impacts(bodies)) {
    impacts.drift[i] = impacts.forced[i] = {};
    if (!bodies[i].is_link) impacts.start_poses[i] = bodies[i].T;
  }
}

// For the bodies that the impact stage moves.
void World::Impl::integrate_forces(double dt) {
  for (const std::uint32_t i : lists.of_impacts(bodies)) {
    Body& body = bodies[i];
    if (body.motion != Motion::dynamic || joins_sub_steps(body)) continue;
    impacts.forced[i] = {body.w, body.v};
    if (body.is_link) continue;
    const Velocity a = context.acceleration_of(body);
    body.v += dt * a.v;
    if (loads.is_torqued(body)) body.w += dt * a.w;
    body.v *= 1.0 / (1.0 + dt * body.linear_damping);
    body.w *= 1.0 / (1.0 + dt * body.angular_damping);
  }
  integrate_articulations(dt);
  for (const std::uint32_t i : lists.of_impacts(bodies)) {
    const Body& body = bodies[i];
    if (joins_sub_steps(body)) continue;
    const bool stopped = !body.is_link && stop_if_out_of_range(context, i, impacts.start_poses[i]);
    if (body.motion != Motion::dynamic) continue;
    impacts.forced[i] =
        stopped ? Velocity{} : Velocity{body.w - impacts.forced[i].w, body.v - impacts.forced[i].v};
  }
}

bool stop_if_out_of_range(const StepContext& s, std::uint32_t index, const SE3& start) {
  Body& body = s.bodies[index];
  if (in_range(body.w) && in_range(body.v) && in_range(body.T.position())) return false;
  s.status.non_finite = true;
  body.w = body.v = {};
  body.prescribed = {};
  body.T = start;
  body.moved();
  restart_displacement(s, index);
  forget_joints(s.bodies[index], s.joints);
  return true;
}

// The body's data for the solver, with its reference point at `at`.
solve::SolverBody World::Impl::solver_body(std::uint32_t index, const Vec3& at) const {
  const Body& body = bodies[index];
  solve::SolverBody s{};
  s.articulation = -1;
  s.w = body.w;
  s.v = body.v;
  s.x = at;
  s.forced_w = impacts.forced[index].w;
  s.forced_v = impacts.forced[index].v;
  if (body.motion != Motion::dynamic) return s;
  if (body.is_link) {
    s.articulation = static_cast<int>(body.articulation);
    s.link = body.link;
  } else {
    s.inverse_mass = body.inverse_mass;
    s.angular =
        body.isotropic ? body.inverse_central : rotated(body.T.rotation(), body.inverse_central);
  }
  return s;
}

// Updates the bodies of `of` except links. Of links and other bodies, updates only those in contact
// or with row joints, which are few.
void World::Impl::refresh_solver_bodies(std::span<const std::uint32_t> of) {
  for (const std::uint32_t i : of) {
    const Body& body = bodies[i];
    if (!body.is_link) impacts.solver_bodies[i] = solver_body(i, reference_point(body));
  }
  for (const solve::ContactConstraint& c : impacts.contacts) {
    for (const std::uint32_t i : {c.a, c.b}) {
      const bool listed = !bodies[i].is_link && bodies[i].motion == Motion::dynamic;
      if (!listed) impacts.solver_bodies[i] = solver_body(i, reference_point(bodies[i]));
    }
  }
  for (const solve::JointPair& pair : impacts.joint_pairs) {
    for (const std::uint32_t i : {pair.a.body, pair.b.body})
      impacts.solver_bodies[i] = solver_body(i, reference_point(bodies[i]));
  }
}

// The constant twist for h. For a tumbling body, the twist that leads to the same final rotation.
collide::Motion World::Impl::motion_of(const Body& body, const Velocity& more, double h) const {
  collide::Motion motion{reference_point(body), body.v + more.v, body.w + more.w};
  const Vec3& mean = more.w == Vec3{} ? body.w : motion.w;
  if (h > 0.0 && body.tumbles() && body.rotates_freely() && !hardly_rotates(mean, h)) {
    const Mat3& R = body.T.rotation();
    const Vec3 w = transposed_times(R, mean);
    const FreeRotation rotation = free_rotation(body.central, body.inverse_central, w, h);
    motion.w = (1.0 / h) * (R * mean_rotation(rotation));
  }
  return motion;
}

// Motions for the rest of the step. Bodies in contact move at the velocity that the solver has
// computed: at the mean velocity, their contacts would approach again at once.
void World::Impl::refresh_motions(double h) {
  if (!impacts.swept_body_pairs.dirty()) {
    for (const std::uint32_t i : lists.of_impacts(bodies)) refresh_motion_of(i, h);
    return;
  }
  for (std::uint32_t i = 0; i < bodies.size(); ++i) {
    if (!bodies[i].remote) refresh_motion_of(i, h);
  }
}
void World::Impl::refresh_motion_of(std::uint32_t i, double h) {
  const Body& body = bodies[i];
  if (body.is_link && body.first_collider == kNone) return;
  const bool stands = impacts.stopped[i] || !body.alive || body.motion == Motion::fixed;
  impacts.motions[i] = stands ? collide::Motion{reference_point(body), {}, {}}
                              : motion_of(body, impacts.drift[i], impacts.in_contact[i] ? 0.0 : h);
}

// Motions and AABBs for the rest of the step.
void World::Impl::refresh_displacements(double h) {
  refresh_motions(h);
  refresh_bounds(h);
  collide_remote(h);
}

namespace {

// The angular velocity of a body after rotation to `next` at a constant twist. It conserves the
// angular momentum. If that would increase the energy, it is constant in the body's frame instead.
Vec3 mean_rate(const Body& body, const Mat3& next) {
  const Mat3& R = body.T.rotation();
  const Vec3 was = transposed_times(R, body.w), momentum = R * (body.central * was);
  const Vec3 w = next * (body.inverse_central * transposed_times(next, momentum));
  return dot(w, momentum) > dot(body.w, momentum) ? next * was : w;
}

}  // namespace

// freely: as a tumbling body without contact, instead of at the constant twist.
void World::Impl::advance_body(Body& body, const collide::Motion& m, double h, bool freely,
                               const Vec3& more_w) {
  const bool tumbles = body.tumbles();
  if (freely && tumbles && body.rotates_freely()) {
    const Rotated free = rotated_freely(body, h, more_w);
    body.w = free.w;
    return place(body, m.x + h * m.v, free.R);
  }
  const Mat3& R = body.T.rotation();
  const bool turns = m.w.x != 0.0 || m.w.y != 0.0 || m.w.z != 0.0;
  const Mat3 next = turns ? rotated(R, h * m.w) : R;
  if (tumbles && turns) {
    body.w = body.rotates_freely() ? mean_rate(body, next) : rate_at(body, next);
  }
  place(body, m.x + h * m.v, next);
}

// Without the impact stage: advances all bodies to the end of the step at once.
void World::Impl::advance_all(double dt) {
  const BodyRows rows = context.rows_in(dt);
  workers.in_parallel(
      lists.awake_bodies.size(), kBodyGrain, [&](std::size_t begin, std::size_t end) {
        for (std::size_t k = begin; k < end; ++k) {
          Body& body = bodies[lists.awake_bodies[k]];
          const bool led = body.motion == Motion::dynamic && body.is_solver_driven();
          sub_step.awake_body_changed[k] = led && rows.advance(body, lists.awake_bodies[k]) ? 0 : 1;
        }
      });
  for (std::size_t k = 0; k < lists.awake_bodies.size(); ++k) {
    if (sub_step.awake_body_changed[k] == 0) continue;
    const std::uint32_t i = lists.awake_bodies[k];
    Body& body = bodies[i];
    const SE3 start = body.T;
    const Velocity more = body.motion == Motion::dynamic ? settle(rows, i) : Velocity{};
    advance_body(body, {reference_point(body), body.v + more.v, body.w + more.w}, dt, true, more.w);
    (void)stop_if_out_of_range(context, i, start);
  }
  forget_lost_bodies();
}

// Updates their separations after the bodies have advanced by h.
void World::Impl::advance_discrete_contacts(double h) {
  for (solve::ContactConstraint& c : impacts.discrete_contacts) {
    const collide::Motion &a = impacts.motions[c.a], &b = impacts.motions[c.b];
    for (int i = 0; i < c.count; ++i) {
      solve::ContactPoint& p = c.points[i];
      const Vec3 u = b.v + cross(b.w, p.position - b.x) - a.v - cross(a.w, p.position - a.x);
      p.separation += h * dot(c.normal, u);
    }
  }
}

void World::Impl::apply_corrections(std::span<const std::uint32_t> of) {
  for (const std::uint32_t i : of) {
    Body& body = bodies[i];
    if (body.is_link || body.motion != Motion::dynamic) continue;
    const solve::SolverBody& s = impacts.solver_bodies[i];
    if (s.shift == Vec3{} && s.rotation == Vec3{}) continue;
    place(body, s.x + s.shift, orthonormalized(Exp(s.rotation).matrix() * body.T.rotation()));
  }
}

namespace {

// Removes a fraction of the velocity that forces have added, as far as it increased the speed.
void take_back(Vec3& velocity, const Vec3& added, double fraction) {
  const double with = dot(added, velocity);
  if (with > 0.0) velocity *= 1.0 - std::min(1.0, fraction * with / dot(velocity, velocity));
}

}  // namespace

// Time does not pass for stopped bodies, so forces must not accelerate them meanwhile. Otherwise
// such a body would gain speed in each step in which it is stopped, and fly off when released.
void World::Impl::take_back_forces(double h) {
  const double fraction = h / dt_now;
  for (const std::uint32_t i : lists.of_impacts(bodies)) {
    Body& body = bodies[i];
    if (!impacts.stopped[i] || body.is_link || body.motion != Motion::dynamic) continue;
    const Velocity a = context.acceleration_of(body);
    take_back(body.v, dt_now * a.v, fraction);
    take_back(body.w, dt_now * a.w, fraction);
  }
  for (Articulation& art : articulations) {
    if (!art.alive || !impacts.stopped[art.bodies.front()]) continue;
    art.take_back_forces(fraction);
    follow(art);
  }
}

// The impact stage is for continuous bodies and for contacts of links.
bool World::Impl::has_impact_stage() const {
  return articulations.size() > free_articulations.size() || lists.some_continuous;
}

void World::Impl::run(double dt) {
  if (finds_contacts) {
    find_contacts(dt);
    list_bodies();  // the narrow phase may have woken some
  }
  sub_step.awake_body_changed.resize(lists.awake_bodies.size());
  counters.awake = static_cast<std::uint32_t>(lists.awake_bodies.size());
  run_sub_steps(dt);
  if (lists.some_sub_stepped) {
    stop_fast_rotating_bodies(
        {bodies, colliders, contact_store, lists.awake_bodies, body_rows,
         sub_step.start_displacements, desc.contact_slop, workers, shapes.parts_scratch},
        sub_step.fast_rotation);
  }
  if (!has_impact_stage()) {
    const auto stage = in(Stage::advance);
    advance_all(dt);
    return;
  }
  feel_forces(dt);
  run_impacts(dt);
}

void World::Impl::find_contacts(double dt) {
  {
    const auto stage = in(Stage::broad_phase);
    contact_search.find_pairs();
    find_bodies_on_links();
  }
  contact_search.update(dt, contact_runs());
}

// Before a sub-step.
SearchedAgain World::Impl::find_contacts_within_step(double left) {
  SearchedAgain changed = contact_search.find_again(left);
  const std::size_t awake = lists.awake_bodies.size();
  list_bodies();
  changed.has_woken = lists.awake_bodies.size() != awake;
  changed.has_old_slots |= changed.has_woken;
  changed.has_new_slots |= changed.has_old_slots;
  sub_step.awake_body_changed.resize(lists.awake_bodies.size());
  return changed;
}

void World::Impl::feel_forces(double dt) {
  const auto stage = in(Stage::forces);
  integrate_forces(dt);
  const BodyRows rows = context.rows_in(dt);
  for (const std::uint32_t i : lists.awake_bodies) {
    if (joins_sub_steps(bodies[i]) && bodies[i].motion == Motion::dynamic) {
      impacts.drift[i] = settle(rows, i);
      if (bodies[i].is_solver_driven()) continue;
      const Velocity a = context.acceleration_of(bodies[i]);
      impacts.forced[i] = {dt * a.w, dt * a.v};
    }
  }
  forget_lost_bodies();
}

void World::Impl::count_contacts() {
  status.manifold_limit |= shapes.manifold_scratch.crowded;
  status.distance_limit |= shapes.manifold_scratch.rough;
  counters.triangles = shapes.manifold_scratch.triangles_tested;
  solve::ColourSet colours;
  for (std::size_t region = 0; region < contact_store.graph.regions(); ++region) {
    colours.insert(contact_store.graph.colours_in_use(region));
    contact_store.graph.colours_in_use(region).for_each([&](int c) {
      counters.manifolds +=
          contact_store.graph.of<1>(region, c).lanes + contact_store.graph.of<4>(region, c).lanes;
    });
  }
  counters.colours = static_cast<std::uint32_t>(colours.size());
  counters.regions = regions.state.count;
  if (colours.has(solve::kLastColour)) status.colour_limit = true;
  counters.pairs += counters.manifolds + contact_store.speculative.size();
  counters.recycled = counters.manifolds - std::min(counters.manifolds, contact_search.renewed());
  counters.events = static_cast<std::uint32_t>(events.all().size());
}

// An overlap that is corrected by the end of the next step is not an error.
void World::Impl::note_position_error() {
  const bool before = std::exchange(sub_step_state.position_error, position_error_now);
  status.position_error = position_error_now && before;
}

void World::Impl::finish_step() {
  ready_for_queries = false;  // an observer of the step may have asked
  count_contacts();
  note_position_error();
  if (desc.sleep_after > 0.0) {
    const auto stage = in(Stage::sleep);
    send_to_sleep();
  }
  std::erase_if(impacts.next_records, [](const PairRecord& r) {
    bool loaded = r.touching;
    for (std::uint32_t i = 0; i < r.count; ++i) loaded |= r.points[i].normal_impulse > 0.0;
    return !loaded;
  });
  impacts.records.swap(impacts.next_records);
  for (Articulation& art : articulations) art.end_step(dt_now);
  clear_loads();
}

}  // namespace vp
