// The order of a step: prepare, find contacts, sub-steps, impact stage, finish.
#include <algorithm>
#include <utility>

#include "vphysics/recording.h"
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
  // Reserves capacity for a busy step, so that the first busy step does not allocate.
  const std::size_t capacity = 64 + 2 * colliders.size() + events.destroyed.size();
  events.reserve(capacity);
  pair_contacts.begin_step(capacity);
  contact_store.reserve(capacity);
  contact_search.begin_step(capacity);
  lost_bodies.reserve(n);
  sleep_islands.reserve(n);
  link_contacts.begin_step(capacity);
  for (Articulation& art : articulations) art.forget_step();
  list_bodies();
  body_states.resize(n + 1);
  contact_store.graph.resize(n + 1);
  divide_into_regions(dt);
  sub_step.blocks.words.reserve(capacity / solve::kLanes +
                                2 * solve::kColours * contact_store.graph.regions());
  if (!lists.awake_bodies.empty()) contact_store.graph.reserve(lists.awake_bodies.size());
  sub_step.start_displacements.resize(n);
  sub_step.velocity_changes.resize(n);
  if (sub_step.some_bounce) sub_step.bounce_shifts.resize(n + 1);
  sub_step.searched.resize(n);
  sub_step.fast_rotation.rotates_fast.reserve(n);
  sub_step.accelerating.clear();
  sub_step.accelerating.reserve(n);
  sub_step.fast_rotation.shortened.reserve(64 + n / 8);  // grows if more bodies rotate fast
  row_solve.forget_joints();
  if (has_impact_stage()) {
    row_solve.begin_step(capacity);
    impacts.begin_step(dt, capacity);
  }
  sub_step.precession.reserve(64 + std::min(n, 2 * joints.size()));  // grows if more precess
  sub_step.joints.runs.reserve(joints.size(), contact_store.graph.regions());
  events.report_destroyed(colliders);
  finds_contacts = contact_search.is_needed();
  if (lists.some_sub_stepped) load_states(dt);
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

// Without the impact stage: advances all bodies to the end of the step at once.
void World::Impl::advance_all(double dt) {
  const BodyStates states = context.states_in(dt);
  workers.in_parallel(
      lists.awake_bodies.size(), kBodyGrain, [&](std::size_t begin, std::size_t end) {
        for (std::size_t k = begin; k < end; ++k) {
          Body& body = bodies[lists.awake_bodies[k]];
          const bool led = body.motion == Motion::dynamic && body.is_solver_driven();
          sub_step.awake_body_changed[k] =
              led && states.advance(body, lists.awake_bodies[k]) ? 0 : 1;
        }
      });
  for (std::size_t k = 0; k < lists.awake_bodies.size(); ++k) {
    if (sub_step.awake_body_changed[k] == 0) continue;
    const std::uint32_t i = lists.awake_bodies[k];
    Body& body = bodies[i];
    const SE3 start = body.T;
    const Velocity more = body.motion == Motion::dynamic ? settle(states, i) : Velocity{};
    advance_body(body, {reference_point(body), body.v + more.v, body.w + more.w}, dt, true, more.w);
    (void)stop_if_out_of_range(context, i, start);
  }
  forget_lost_bodies();
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
  link_contacts.find_fast(dt);
  if (has_impact_stage()) impacts.note_start();
  sub_step.awake_body_changed.resize(lists.awake_bodies.size());
  counters.awake = static_cast<std::uint32_t>(lists.awake_bodies.size());
  run_sub_steps(dt);
  if (lists.some_sub_stepped) stop_fast_rotating_bodies(context, sub_step.fast_rotation);
  if (!has_impact_stage()) {
    const auto stage = in(Stage::advance);
    advance_all(dt);
    return;
  }
  feel_forces(dt);
  const auto stage = in(Stage::impacts);
  link_contacts.end_sub_steps(dt, sub_steps_taken, impacts.drift());
  impacts.run(dt);
}

void World::Impl::find_contacts(double dt) {
  {
    const auto stage = in(Stage::broad_phase);
    contact_search.find_pairs();
    link_contacts.find_bodies();
  }
  contact_search.update(dt, contact_runs());
}

// Before a sub-step.
SearchedAgain World::Impl::find_contacts_within_step(double left) {
  SearchedAgain changed = contact_search.find_again(left, sub_step.precession.on_contacts());
  const std::size_t awake = lists.awake_bodies.size();
  list_bodies();
  changed.has_woken = lists.awake_bodies.size() != awake;
  if (changed.has_woken && has_impact_stage()) impacts.note_start();
  changed.has_old_slots |= changed.has_woken;
  changed.has_new_slots |= changed.has_old_slots;
  sub_step.awake_body_changed.resize(lists.awake_bodies.size());
  return changed;
}

void World::Impl::feel_forces(double dt) {
  const auto stage = in(Stage::forces);
  impacts.integrate_forces(dt);
  const BodyStates states = context.states_in(dt);
  for (const std::uint32_t i : lists.awake_bodies) {
    if (joins_sub_steps(bodies[i]) && bodies[i].motion == Motion::dynamic)
      impacts.note_sub_steps_of(i, settle(states, i));
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
          contact_store.graph.of<1>(region, c).slots + contact_store.graph.of<4>(region, c).slots;
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
  pair_contacts.end_step();
  for (Articulation& art : articulations) art.end_step(dt_now);
  clear_loads();
}

}  // namespace vp
