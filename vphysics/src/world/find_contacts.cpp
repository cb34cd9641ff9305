// The search for contacts at the start of a step.
#include <algorithm>
#include <optional>
#include <span>

#include "world/contact_search.h"
#include "world/prefetch.h"

namespace vp {
namespace {

// A contact is computed again when the two have rotated by more [rad]. The separation of a point at
// an arm r then has an error of r angle^2 / 2: a thirtieth of a millimetre for a box of a metre.
constexpr double kRevolution = 0.01;
// Contacts whose test takes some microseconds, and whose listing does.
constexpr std::size_t kNarrowPhaseGrain = 16, kListGrain = 128;
static_assert(kContactBatch % kNarrowPhaseGrain == 0);

// A sphere touches a convex shape at one point.
int points_of(const Contact& c, const Collider& a, const Collider& b) {
  const bool ball = kind_of_part(a.geometry, c.sub_a) == collide::Kind::sphere ||
                    kind_of_part(b.geometry, c.sub_b) == collide::Kind::sphere;
  return ball ? 1 : collide::kMaxPoints;
}

}  // namespace

bool ContactSearch::is_needed() const {
  return s_.lists.some_sub_stepped ||
         (s_.lists.some_sleep &&
          (s_.finder.has_moved() || !s_.contact_store.dirty.empty() || !s_.lists.links.empty()));
}

void ContactSearch::begin_step(std::size_t contacts) {
  renewed_ = 0;
  for (auto* list : {&dirty_, &dirty_next_step_}) list->reserve(s_.contact_store.dirty.capacity());
  verdicts_.reserve(dirty_.capacity());
  results_.reserve(std::min(contacts, kContactBatch));
  part_searches_.resize(kContactBatch / kNarrowPhaseGrain);
  if (s_.workers.scheduler) reserve_part_searches();
  writer_.reserve();
  new_pairs_.reserve(contacts);
  const std::size_t n = s_.bodies.size();
  if (n <= deviating_.capacity()) return;
  deviating_.reserve(n);
  deviates_.reserve(n);
  advanced_.reserve(64 + n / 8);  // grows in a step in which more bodies deviate
}

void ContactSearch::find_pairs() {
  find_new_contacts();
  drop_separated_link_contacts();
}

void ContactSearch::find_new_contacts() {
  new_pairs_.clear();
  s_.finder.update(new_pairs_, s_.workers);
  for (const collide::ProxyPair& pair : new_pairs_) {
    add_contact_pair(s_.finder.user(pair.a), s_.finder.user(pair.b));
  }
}

bool ContactSearch::has_separated(const Contact& c) const {
  return !s_.finder.should_pair(s_.colliders[c.a].proxy, s_.colliders[c.b].proxy);
}
void ContactSearch::drop(std::uint32_t index) {
  Contact& c = s_.contact_store[index];
  s_.finder.remove_pair(s_.colliders[c.a].proxy, s_.colliders[c.b].proxy);
  if (c.touching && !c.is_part()) s_.events.touch(s_.colliders, c, false);
  s_.contact_store.remove(index, s_.body_set);
}

// Contacts of links are tested elsewhere. All other contacts are removed when they are tested and
// their enlarged bounds have separated, so this needs no pass over them.
void ContactSearch::drop_separated_link_contacts() {
  if (s_.lists.links.empty()) return;
  for (const std::uint32_t proxy : s_.finder.moved()) {
    if (!s_.finder.exists(proxy)) continue;
    const std::uint32_t collider = s_.finder.user(proxy);
    s_.contact_store.for_each_of(
        s_.bodies[s_.colliders[collider].body], [&](std::uint32_t i, Contact& c) {
          if (c.of_link && (c.a == collider || c.b == collider) && has_separated(c)) drop(i);
        });
  }
}

void ContactSearch::add_contact_pair(std::uint32_t i, std::uint32_t j) {
  const ColliderPair pair = make_pair(s_.colliders, i, j);
  const Collider &a = s_.colliders[pair.a], &b = s_.colliders[pair.b];
  const Body &body_a = s_.bodies[a.body], &body_b = s_.bodies[b.body];
  const bool sensor = a.sensor || b.sensor;
  const bool pushes = body_a.motion == Motion::dynamic || body_b.motion == Motion::dynamic;
  if (!should_collide(a, b) || never_collide(body_a, body_b) || !(pushes || sensor)) return;
  Contact c;
  c.key = pair.key;
  c.a = pair.a;
  c.b = pair.b;
  c.sensor = sensor;
  c.of_link = body_a.is_link || body_b.is_link;
  c.has_parts = has_parts(a.geometry, b.geometry);
  const std::uint32_t index = s_.contact_store.add(c, s_.body_set);
  if (!c.of_link) s_.contact_store.mark_dirty(index);
  s_.contact_store.set_speculative(index, {}, s_.body_set);
  s_.contact_store.reset_speculative(s_.contact_store[index], s_.body_set);
}

void ContactSearch::find_dirty_contacts(double dt, const ContactRuns& runs) {
  const float step = static_cast<float>(dt);
  std::vector<std::uint32_t>& found = runs.block_bits.words;
  (void)runs.number();
  runs.for_parts([&](const auto& pass, const auto& part, std::size_t first) {
    pass.find_moved(part, step, static_cast<float>(kRevolution), found.data() + first);
  });
  std::size_t next = 0;
  runs.for_runs([&](const auto&, const auto&, const auto& blocks) {
    for (const auto& block : blocks)
      s_.contact_store.mark_dirty_slots(block.contact, found[next++]);
  });
  const std::span<solve::SpeculativeBlock> blocks = s_.contact_store.speculative.blocks();
  found.resize(std::max(found.size(), blocks.size()));
  s_.workers.in_parallel(
      blocks.size(), kBodyGrain / solve::kLanes, [&](std::size_t begin, std::size_t end) {
        solve::passes().find_closer(blocks.data() + begin, end - begin, s_.body_states.data(), step,
                                    found.data() + begin);
      });
  for (std::size_t b = 0; b < blocks.size(); ++b)
    s_.contact_store.mark_dirty_pairs(blocks[b], found[b]);
}

// Tests dirty contacts in the order of their slots, those without one in the order of their
// indices; then those of bodies that these have woken.
void ContactSearch::update(double dt, const ContactRuns& runs) {
  dirty_next_step_.clear();
  for (bool first = true; first || !s_.contact_store.dirty.empty(); first = false) {
    std::size_t done = 0;
    do {
      {
        const auto stage = s_.in(Stage::narrow_phase);
        if (first && done == 0) find_dirty_contacts(dt, runs);
        if (done == 0) list_dirty_contacts(runs);
        const std::span<const std::uint32_t> left = std::span(dirty_).subspan(done);
        find_manifolds_of(left.first(std::min(left.size(), kContactBatch)), dt);
      }
      const auto stage = s_.in(Stage::contact_slots);
      for (const NarrowPhaseResult& found : results_) take_over(found, false);
      writer_.write();
      done += results_.size();
    } while (done < dirty_.size());
  }
  s_.contact_store.dirty.swap(dirty_next_step_);
}

// Lists the contacts to test, and poses their colliders. Removes those whose enlarged bounds have
// separated.
void ContactSearch::list_dirty_contacts(const ContactRuns& runs) {
  s_.contact_store.take_dirty(dirty_, [&](const auto& visit) {
    runs.for_runs([&](const auto&, const auto&, const auto& blocks) {
      for (const auto& block : blocks) visit(block.contact);
    });
  });
  verdicts_.resize(dirty_.size());
  s_.workers.in_parallel(dirty_.size(), kListGrain, [&](std::size_t begin, std::size_t end) {
    for (std::size_t k = begin; k < end; ++k) {
      prefetch_contacts(
          s_, [&](std::size_t i) { return dirty_[i]; }, k, end);
      verdicts_[k] = judge(s_.contact_store[dirty_[k]]);
    }
  });
  std::size_t count = 0;
  for (std::size_t k = 0; k < dirty_.size(); ++k) {
    if (verdicts_[k] == Verdict::separated) drop(dirty_[k]);
    if (verdicts_[k] == Verdict::test) dirty_[count++] = dirty_[k];
  }
  dirty_.resize(count);
}

ContactSearch::Verdict ContactSearch::judge(const Contact& c) const {
  if (!c.alive || !c.dirty || c.parked) return Verdict::skip;
  if (c.of_link) return Verdict::skip;  // tested in link_contacts.cpp
  if (has_separated(c)) return Verdict::separated;
  for (const std::uint32_t collider : {c.a, c.b})
    pose_colliders_once(s_.bodies[s_.colliders[collider].body], s_.colliders);
  return Verdict::test;
}

// Precondition: at most kContactBatch.
void ContactSearch::find_manifolds_of(std::span<const std::uint32_t> contacts, double dt) {
  std::vector<NarrowPhaseResult>& results = results_;
  results.resize(contacts.size());
  const Approach approach = s_.approach_in(dt);
  for (PartSearch& search : part_searches_) search.manifolds.clear();
  s_.workers.in_parallel(results.size(), kNarrowPhaseGrain,
                         [&](std::size_t begin, std::size_t end) {
                           const std::size_t search = begin / kNarrowPhaseGrain;
                           for (std::size_t k = begin; k < end; ++k) {
                             const auto contact_at = [&](std::size_t i) { return contacts[i]; };
                             prefetch_contacts(s_, contact_at, k, end);
                             prefetch_clearances(s_, contact_at, k, end);
                             results[k].contact = contacts[k];
                             results[k].search = static_cast<std::uint32_t>(search);
                             find_manifold_of(s_.contact_store[contacts[k]], results[k], approach,
                                              part_searches_[search]);
                           }
                         });
  note_part_searches();
}

void ContactSearch::find_manifold_of(Contact& c, NarrowPhaseResult& found, const Approach& approach,
                                     PartSearch& search) const {
  const Collider &a = s_.colliders[c.a], &b = s_.colliders[c.b];
  const double slop = s_.desc.contact_slop;
  found.margin_at_rest = c.sensor ? 0.0 : slop + slide_limit(a, b);
  found.manifold.count = 0;
  found.manifold.rough = false;
  found.to_impact = {};
  found.first = found.count = 0;
  std::optional<Apart> apart;
  if (disables_collision(s_.bodies, s_.joints, a.body, b.body)) {
    found.clearance = {kNeverTouches};
  } else if (!c.sensor && (apart = approach.spheres_apart(a, b, found.margin_at_rest))) {
    found.clearance = {apart->distance - slop, apart->normal, true};
  } else {
    found.margin = c.sensor ? 0.0 : found.margin_at_rest + approach.of(a, b);
    c.has_parts ? find_parts(c, found, approach, search) : find_convex(c, found, approach);
  }
  found.taken_over = stays_without_points(c, found);
  if (!found.taken_over) return;
  s_.contact_store.set_clearance(c, found.clearance, s_.body_set);
  c.dirty = false;
}

void ContactSearch::find_convex(Contact& c, NarrowPhaseResult& found,
                                const Approach& approach) const {
  const Collider &a = s_.colliders[c.a], &b = s_.colliders[c.b];
  find_manifold(a.geometry, a.T, b.geometry, b.T,
                approach.margin(a, b, found.margin, found.margin_at_rest), c.cache, found.manifold);
  if (found.manifold.count > 0 && !c.sensor)
    found.to_impact =
        move_to_impact(a.geometry, a.T, b.geometry, b.T,
                       approach.motion(a, b, found.margin_at_rest), found.margin, found.manifold);
  found.clearance = {found.manifold.min_separation - s_.desc.contact_slop, found.manifold.normal};
}

// Then nothing but its own clearance changes: no slot, no event, and no contact is parked.
bool ContactSearch::stays_without_points(const Contact& c, const NarrowPhaseResult& found) const {
  const auto is_still_body = [&](std::uint32_t collider) {
    return is_still(s_.bodies[s_.colliders[collider].body]);
  };
  const bool without_points =
      c.slot.points == 0 && c.first_part == kNone && found.manifold.count == 0 && found.count == 0;
  return without_points && !c.sensor && !c.touching && !c.parked &&
         !(is_still_body(c.a) && is_still_body(c.b));
}

void ContactSearch::take_over(const NarrowPhaseResult& found, bool within_step) {
  const std::uint32_t index = found.contact;
  const bool separated = found.clearance.distance >= kNeverTouches;
  if (!separated) ++s_.counters.narrow_phase_pairs;
  s_.status.distance_limit |= found.manifold.rough;
  if (found.taken_over) return;
  s_.contact_store[index].dirty = false;
  if (s_.contact_store[index].sensor) {
    const bool collides = found.manifold.count > 0 || found.count > 0;
    if (collides != s_.contact_store[index].touching)
      s_.events.touch(s_.colliders, s_.contact_store[index], collides);
  } else if (s_.contact_store[index].has_parts) {
    if (separated) {
      s_.contact_store.remove_parts(index, s_.body_set);
    } else {
      take_over_parts(found, within_step);
    }
  } else if (found.manifold.count > 0) {
    assign_slot(index, found.manifold, found.to_impact);
    return;
  }
  Contact& c = s_.contact_store[index];  // the pool may have grown
  if (c.sensor) {
    c.dirty = true;
  } else if (!c.has_parts || separated) {
    if (c.touching) s_.events.touch(s_.colliders, c, false);
    if (c.slot.points > 0) {
      s_.contact_store.release_slot(index, s_.body_set);
      s_.contact_store.set_speculative(index, found.clearance, s_.body_set);
    } else {
      s_.contact_store.set_clearance(c, found.clearance, s_.body_set);
    }
  }
  s_.contact_store.park(index,
                        s_.body_set);  // it has no points: parks it if nothing awake may change it
  if (c.sensor && !c.parked) dirty_next_step_.push_back(index);  // in the next step
}

void ContactSearch::assign_slot(std::uint32_t index, const collide::Manifold& m,
                                const collide::MotionToImpact& to_impact) {
  const Contact& c = s_.contact_store[index];
  ++renewed_;
  const Collider &a = s_.colliders[c.a], &b = s_.colliders[c.b];
  wake(s_, a.body);
  wake(s_, b.body);
  if (c.slot.points == 0) s_.contact_store.assign_slot(index, points_of(c, a, b), s_.body_set);
  writer_.add(index, m, to_impact);
}

}  // namespace vp
