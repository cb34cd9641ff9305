// Finds contacts again between two sub-steps, for bodies whose velocity has changed.
//
// The search at the start of a step extrapolates all bodies at their velocities at that time. An
// impact within the step may throw a body elsewhere. So the search is repeated before a sub-step
// for each body that will deviate from the extrapolated motion by more than a fraction of its size
// in the remaining time (SearchedMotion). Its bounds are enlarged by the rest of its motion, and
// its pairs that may touch in that time are tested at the poses of the sub-step. The other bodies
// keep their contacts. Contacts of links are not searched for.
#include <algorithm>
#include <atomic>
#include <span>

#include "solve/state_vector.h"
#include "world/contact_search.h"
#include "world/validate.h"

namespace vp {
namespace {
// A state that has left the range of numbers stops its body at the end of the step.
bool is_in_range(const solve::BodyState& state) {
  return in_range(vector_of(state.velocity)) && in_range(vector_of(state.velocity + 3)) &&
         in_range(vector_of(state.displacement)) && in_range(vector_of(state.displacement + 3));
}

// Whether the geometry of a contact slot will be useless before the step ends: the two will have
// moved past each other by more than half of the extent of the smaller one.
bool outruns_its_slot(const Contact& c, double left, const BodySet& on) {
  const Collider &a = on.colliders[c.a], &b = on.colliders[c.b];
  const auto v = [&](const Collider& x, int first) {
    return vector_of(on.states[end_of(on.bodies, x.body).state].velocity + first);
  };
  const double speed =
      norm(v(b, 0) - v(a, 0)) + vicinity_of(on.bodies, a, b).radius * norm(v(b, 3) - v(a, 3));
  return speed * left > smaller_size(a, b);
}

// Copies the bodies' inverse inertias into a slot, as load_inertias does for all at the start.
template <int P>
void load_inertias_of(solve::ContactBlock<P>& block, int lane,
                      std::span<const solve::BodyState> states) {
  const auto load = [&](solve::FieldSym3& to, std::uint32_t state) {
    const float* from = states[state].inertia;
    solve::Field* fields[] = {&to.xx, &to.yy, &to.zz, &to.xy, &to.yz, &to.zx};
    for (int i = 0; i < 6; ++i) fields[i]->lane[lane] = from[i];
  };
  load(block.inertia_a, block.a.lane[lane]);
  load(block.inertia_b, block.b.lane[lane]);
}

}  // namespace

void ContactSearch::load_inertias_of(const Contact& c) {
  if (c.slot.points == 0) return;
  solve::ContactGraph& graph = s_.contact_store.graph;
  const int lane = solve::ContactGraph::lane(c.slot);
  c.slot.points == 1
      ? vp::load_inertias_of(graph.block<1>(c.slot), lane, std::span(s_.body_states))
      : vp::load_inertias_of(graph.block<4>(c.slot), lane, std::span(s_.body_states));
}

bool ContactSearch::list_deviating_bodies(double left) {
  const std::vector<std::uint32_t>& awake = s_.lists.awake_bodies;
  std::vector<std::uint8_t>& flags = deviates_;
  flags.resize(awake.size());
  std::atomic<bool> some = false;
  s_.workers.in_parallel(awake.size(), kBodyGrain, [&](std::size_t begin, std::size_t end) {
    if (solve::passes().find_deviating(s_.body_states.data(), s_.searched.data(),
                                       awake.data() + begin, end - begin, static_cast<float>(left),
                                       flags.data() + begin))
      some.store(true, std::memory_order_relaxed);
  });
  deviating_.clear();
  if (!some) return false;
  for (std::size_t k = 0; k < awake.size(); ++k) {
    const std::uint32_t i = awake[k];
    if (flags[k] != 0 && joins_sub_steps(s_.bodies[i]) && is_in_range(s_.body_states[i + 1]))
      deviating_.push_back(i);
  }
  return !deviating_.empty();
}

// Sets the pose and the velocities of a body to those of the present sub-step.
void ContactSearch::advance_within_step(std::uint32_t index, const BodyStates& states) {
  Body& body = s_.bodies[index];
  if (body.advanced || body.asleep || !joins_sub_steps(body)) return;
  body.advanced = true;
  advanced_.push_back({index, body.T, body.w, body.v});
  states.copy_to_body(body, index);
}

// Marks the contacts to test.
void ContactSearch::list_contacts_of_deviating(double left, const BodyStates& states) {
  for (const std::uint32_t i : deviating_) {
    advance_within_step(i, states);
    if (!has_bounds_for(s_, i, left)) update_bounds(s_, i, left, true);
    states.note_searched(i);
  }
  find_new_contacts();
  for (const std::uint32_t i : deviating_) {
    s_.contact_store.for_each_of(s_.bodies[i], [&](std::uint32_t index, const Contact& c) {
      if (c.dirty || c.of_link || c.sensor || c.parked || c.is_part()) return;
      if (c.slot.points > 0 ? outruns_its_slot(c, left, s_.body_set)
                            : s_.contact_store.may_touch_within(c, left, s_.body_set))
        s_.contact_store.mark_dirty(index);
    });
  }
}

void ContactSearch::list_contacts_of_precessing(std::span<const std::uint32_t> precessing) {
  for (const std::uint32_t i : precessing) {
    if (!is_in_range(s_.body_states[i + 1])) continue;
    s_.contact_store.for_each_of(s_.bodies[i], [&](std::uint32_t index, const Contact& c) {
      if (c.dirty || c.of_link || c.sensor || c.parked || c.is_part()) return;
      if (c.touching && (c.slot.points > 0 || c.first_part != kNone))
        s_.contact_store.mark_dirty(index);
    });
  }
}

// Moves the contacts to test, and the poses of their bodies, to dirty_.
void ContactSearch::take_contacts_to_test(const BodyStates& states) {
  s_.contact_store.take_dirty(dirty_);
  std::erase_if(dirty_, [&](std::uint32_t index) {
    const Contact& c = s_.contact_store[index];
    if (!c.alive || !c.dirty) return true;
    const std::uint32_t a = s_.colliders[c.a].body, b = s_.colliders[c.b].body;
    // The joints of a woken island would not be solved in this step.
    const bool wakes_joints = (s_.bodies[a].asleep || s_.bodies[b].asleep) && !s_.joints.empty();
    const bool must_wait =
        wakes_joints || !is_in_range(s_.body_states[a + 1]) || !is_in_range(s_.body_states[b + 1]);
    if (c.sensor || must_wait) dirty_next_step_.push_back(index);
    if (c.sensor || c.of_link || must_wait) return true;
    for (const std::uint32_t body : {a, b}) {
      advance_within_step(body, states);
      pose_colliders(s_.bodies[body], s_.colliders);
    }
    return false;
  });
}

SearchedAgain ContactSearch::find_again(double left, std::span<const std::uint32_t> precessing) {
  SearchedAgain changed;
  const bool some_deviate = list_deviating_bodies(left);
  if (!some_deviate && precessing.empty()) return changed;
  // Contacts that wait for the next step are not tested now.
  dirty_next_step_.clear();
  dirty_next_step_.swap(s_.contact_store.dirty);
  const BodyStates states = s_.states_in(s_.dt);
  if (some_deviate) list_contacts_of_deviating(left, states);
  list_contacts_of_precessing(precessing);
  take_contacts_to_test(states);
  for (std::size_t done = 0; done < dirty_.size(); done += results_.size()) {
    const std::span<const std::uint32_t> waiting = std::span(dirty_).subspan(done);
    find_manifolds_of(waiting.first(std::min(waiting.size(), kContactBatch)), left);
    for (const NarrowPhaseResult& found : results_) {
      Contact& c = s_.contact_store[found.contact];
      const bool had_slots = c.slot.points > 0 || c.first_part != kNone;
      // A slot whose impulses are not reported yet is not released.
      if (c.slot.points > 0 && found.manifold.count == 0) {
        c.dirty = false;
        continue;
      }
      const std::uint32_t renewed = renewed_;
      take_over(found, true);
      changed.has_new_slots |= renewed_ != renewed;
      const Contact& taken = s_.contact_store[found.contact];  // the pool may have grown
      load_inertias_of(taken);
      for (std::uint32_t p = taken.first_part; p != kNone; p = s_.contact_store[p].next_part)
        load_inertias_of(s_.contact_store[p]);
      changed.has_old_slots |= had_slots;
    }
    writer_.write();
  }
  s_.contact_store.dirty.insert(s_.contact_store.dirty.end(), dirty_next_step_.begin(),
                                dirty_next_step_.end());
  for (const BodyAtStart& start : advanced_) {
    Body& body = s_.bodies[start.body];
    body.T = start.T;
    body.w = start.w;
    body.v = start.v;
    body.advanced = false;
    body.moved();
  }
  advanced_.clear();
  return changed;
}

}  // namespace vp
