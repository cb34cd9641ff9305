#include "world/contact_store.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <utility>

#include "solve/state_vector.h"

namespace vp {
namespace {

// A clearance goes on when a state's displacement restarts, until single precision may not resolve
// it any more: the body has moved this many times as far as to the last restart, and as its
// clearance. Or it has rotated so far [rad].
constexpr float kMaxRestarts = 4.0f, kMaxOfClearance = 1024.0f, kMaxRotationSum = 0.25f;

// Motion of one body of a pair: displacement at the centre of the vicinity sphere, rotation, and
// the error bound of that displacement.
struct PairMotion {
  Vec3 displacement, rotation;
  double arc_error;
};

// How much nearer the two of a pair may have come since its clearance was set, and will have come
// after a further `time` [s] at the states' present velocities. The same bound as find_closer.
double max_approach(const solve::SpeculativePair& pair, const BodySet& on, double time) {
  const auto motion = [&](std::uint32_t state, const float* rotation, const float* arm) {
    const solve::BodyState& now = on.states[state];
    Vec3 moved = vector_of(now.displacement);
    Vec3 by = vector_of(now.displacement + 3) - vector_of(rotation);
    if (time > 0.0) {
      moved += time * vector_of(now.velocity);
      by += time * vector_of(now.velocity + 3);
    }
    const Vec3 r = vector_of(arm);
    return PairMotion{moved + cross(by, r), by, 0.5 * dot(by, by) * norm(r)};
  };
  const PairMotion a = motion(pair.a, pair.rotation_a, pair.arm_a);
  const PairMotion b = motion(pair.b, pair.rotation_b, pair.arm_b);
  const Vec3 moved = b.displacement - a.displacement - vector_of(pair.x),
             normal = vector_of(pair.normal);
  const double rotated = static_cast<double>(pair.radius) * norm(b.rotation - a.rotation);
  const double turned = is_between_spheres(pair)
                            ? 0.0
                            : norm(pair.turns_with > 0.0f ? a.rotation : b.rotation) * norm(moved);
  const double approached = normal == Vec3{} ? norm(moved) : turned - dot(normal, moved);
  return approached + rotated + a.arc_error + b.arc_error;
}

}  // namespace

void ContactStore::reserve(std::size_t contacts) {
  pool.reserve(contacts);
  // Parts are contacts of their own.
  for (auto* list : {&free, &dirty}) list->reserve(std::max(contacts, pool.capacity()));
  speculative.reserve(contacts);
}

void ContactStore::clear() {
  pool.clear();
  free.clear();
  graph.clear();
  speculative.clear();
  parked_speculative.clear();
  dirty.clear();
  points = 0;
}

std::uint32_t ContactStore::add(const Contact& contact, const BodySet& on) {
  const std::uint32_t index = take_slot(pool, free);
  Contact& c = pool[index];
  c = contact;
  c.alive = true;
  for (const int side : {0, 1}) {
    Body& body = on.bodies[on.colliders[side == 0 ? c.a : c.b].body];
    const std::uint32_t edge = 2 * index + static_cast<std::uint32_t>(side);
    c.next[side] = body.first_edge;
    c.previous[side] = kNone;
    if (body.first_edge != kNone) pool[body.first_edge / 2].previous[body.first_edge % 2] = edge;
    body.first_edge = edge;
  }
  return index;
}

void ContactStore::remove(std::uint32_t index, const BodySet& on) {
  Contact& c = pool[index];
  if (c.has_parts) remove_parts(index, on);
  if (c.slot.points > 0) {
    release_slot(index, on);
  } else {
    unset_speculative(index);
  }
  for (const int side : {0, 1}) {
    Body& body = on.bodies[on.colliders[side == 0 ? c.a : c.b].body];
    const std::uint32_t next = c.next[side], previous = c.previous[side];
    if (next != kNone) pool[next / 2].previous[next % 2] = previous;
    (previous != kNone ? pool[previous / 2].next[previous % 2] : body.first_edge) = next;
  }
  c.alive = false;
  free.push_back(index);
}

void ContactStore::remove_parts(std::uint32_t index, const BodySet& on) {
  std::uint32_t next = kNone;
  for (std::uint32_t p = pool[index].first_part; p != kNone; p = next) {
    next = pool[p].next_part;
    remove(p, on);
  }
  pool[index].first_part = kNone;
}

void ContactStore::forget_part(std::uint32_t index, const BodySet& on) {
  Contact& aggregate = pool[pool[index].aggregate];
  mark_dirty(index);
  std::uint32_t* link = &aggregate.first_part;
  while (*link != index) link = &pool[*link].next_part;
  *link = pool[index].next_part;
  remove(index, on);
}

bool ContactStore::touches_in_parts(const Contact& aggregate) const {
  for (std::uint32_t p = aggregate.first_part; p != kNone; p = pool[p].next_part) {
    if (pool[p].touching) return true;
  }
  return false;
}

void ContactStore::assign_slot(std::uint32_t index, int max_points, const BodySet& on) {
  Contact& c = pool[index];
  const std::uint32_t a = on.colliders[c.a].body, b = on.colliders[c.b].body;
  if (!c.is_part()) unset_speculative(index);
  c.slot = graph.add(index, end_of(on.bodies, a), end_of(on.bodies, b), max_points);
  ++on.bodies[a].contact_slots;
  ++on.bodies[b].contact_slots;
}

void ContactStore::release_slot(std::uint32_t index, const BodySet& on) {
  Contact& c = pool[index];
  const std::uint32_t a = on.colliders[c.a].body, b = on.colliders[c.b].body;
  const std::uint32_t moved = graph.remove(c.slot, end_of(on.bodies, a), end_of(on.bodies, b));
  if (moved != solve::kNoContact) pool[moved].slot = c.slot;
  c.slot = {};
  if (!c.parked) points -= c.count;
  c.count = 0;
  --on.bodies[a].contact_slots;
  --on.bodies[b].contact_slots;
}

void ContactStore::mark_moved(const Contact& c) {
  constexpr float kFar = 1e9f;
  const auto lane = static_cast<std::size_t>(solve::ContactGraph::lane(c.slot));
  (c.slot.points == 1 ? graph.block<1>(c.slot).slid : graph.block<4>(c.slot).slid).x.lane[lane] =
      kFar;
}

ContactStore::States ContactStore::states_of(const Contact& c) const {
  const auto of_slot = [&](const auto& block) {
    const auto lane = static_cast<std::size_t>(solve::ContactGraph::lane(c.slot));
    return States{block.a.lane[lane], block.b.lane[lane]};
  };
  if (c.slot.points == 1) return of_slot(graph.block<1>(c.slot));
  if (c.slot.points > 0) return of_slot(graph.block<4>(c.slot));
  const solve::SpeculativePair& pair =
      (c.parked ? parked_speculative : speculative).pair(c.speculative_index);
  return {pair.a, pair.b};
}

void ContactStore::follow_region(const Body& body, const BodySet& on) {
  for_each_of(body, [&](std::uint32_t, Contact& c) {
    if (c.slot.points == 0 || c.parked) return;
    const solve::ContactSlot left = c.slot;
    const std::uint32_t moved = graph.follow(c.slot, end_of(on.bodies, on.colliders[c.a].body),
                                             end_of(on.bodies, on.colliders[c.b].body));
    if (moved != solve::kNoContact) pool[moved].slot = left;
  });
}

void ContactStore::set_speculative(std::uint32_t index, const Clearance& clearance,
                                   const BodySet& on) {
  Contact& c = pool[index];
  const std::uint32_t a = on.colliders[c.a].body, b = on.colliders[c.b].body;
  c.speculative_index =
      speculative.add(index, end_of(on.bodies, a).state, end_of(on.bodies, b).state);
  set_clearance(c, clearance, on);
}

void ContactStore::set_clearance(const Contact& c, const Clearance& clearance, const BodySet& on) {
  solve::SpeculativePair& pair = speculative.pair(c.speculative_index);
  const Collider &a = on.colliders[c.a], &b = on.colliders[c.b];
  const Vicinity at = vicinity_of(on.bodies, a, b);
  const float *x_a = on.states[pair.a].displacement, *x_b = on.states[pair.b].displacement;
  for (int i = 0; i < 3; ++i) pair.x[i] = x_b[i] - x_a[i];
  const auto put_end = [&](std::uint32_t state, const Body& body, float* rotation, float* arm) {
    std::copy_n(on.states[state].displacement + 3, 3, rotation);
    // Without a clearance any motion uses it up, so that the poses need not be those of one time.
    const bool has_arm =
        state != solve::kWorldState && clearance.distance > 0.0 && !clearance.of_spheres;
    put(arm, has_arm ? at.centre - reference_point(body) : Vec3{});
  };
  put_end(pair.a, on.bodies[a.body], pair.rotation_a, pair.arm_a);
  put_end(pair.b, on.bodies[b.body], pair.rotation_b, pair.arm_b);
  put(pair.normal, clearance.normal);
  pair.clearance = static_cast<float>(clearance.distance);
  pair.radius = clearance.of_spheres ? 0.0f : static_cast<float>(at.radius);
  pair.turns_with = clearance.of_spheres ? -1.0f : at.is_of_b ? 1.0f : 0.0f;
}

void ContactStore::reset_speculative(const Contact& c, const BodySet& on) {
  set_clearance(c, {c.of_link ? kNeverTouches : 0.0}, on);
}

void ContactStore::unset_speculative(std::uint32_t index) {
  const std::uint32_t slot = pool[index].speculative_index;
  const std::uint32_t moved = (pool[index].parked ? parked_speculative : speculative).remove(slot);
  if (moved != solve::kNoContact) pool[moved].speculative_index = slot;
}

bool ContactStore::use_clearance(const Contact& c, const BodySet& on) {
  const solve::SpeculativePair& pair = speculative.pair(c.speculative_index);
  const double left = static_cast<double>(pair.clearance) - max_approach(pair, on, 0.0);
  if (!(left > 0.0)) return false;
  set_clearance(c, {left}, on);  // the normal has rotated
  return true;
}

bool ContactStore::follow_restart(const Contact& c, std::uint32_t state,
                                  const float* displacement) {
  solve::SpeculativePair& pair = speculative.pair(c.speculative_index);
  const bool is_a = pair.a == state;
  float restart = 0.0f, moved = 0.0f;
  for (int i = 0; i < 3; ++i) {
    pair.x[i] += is_a ? displacement[i] : -displacement[i];
    restart = std::max(restart, std::fabs(displacement[i]));
    moved = std::max(moved, std::fabs(pair.x[i]));
  }
  const bool is_precise =
      moved <= std::max(kMaxRestarts * restart, kMaxOfClearance * pair.clearance);
  if (is_between_spheres(pair)) return is_precise;
  float* const rotation = is_a ? pair.rotation_a : pair.rotation_b;
  for (int i = 0; i < 3; ++i) rotation[i] -= displacement[3 + i];
  // Rotations are added as vectors. What their order makes of two is at most half of their product.
  const auto rotated = static_cast<float>(norm(vector_of(rotation)));
  const auto last = static_cast<float>(norm(vector_of(displacement + 3)));
  const auto arm = static_cast<float>(norm(vector_of(is_a ? pair.arm_a : pair.arm_b)));
  pair.clearance -= last * std::max(last, rotated) * (arm + pair.radius);
  return is_precise && rotated <= kMaxRotationSum;
}

bool ContactStore::may_touch_within(const Contact& c, double time, const BodySet& on) const {
  const solve::SpeculativePair& pair = speculative.pair(c.speculative_index);
  const auto clearance = static_cast<double>(pair.clearance);
  return clearance < kNeverTouches && !(max_approach(pair, on, time) <= clearance);
}

// Does nothing if something awake may change the contact: a speculative pair with one body awake or
// kinematic. A kinematic body that touches a sleeping one is at rest; setting it in motion wakes
// the other.
void ContactStore::park(std::uint32_t index, const BodySet& on) {
  Contact& c = pool[index];
  const std::uint32_t a = on.colliders[c.a].body, b = on.colliders[c.b].body;
  if (c.parked) return;
  if (c.slot.points > 0) {
    const solve::ContactSlot left = c.slot;
    const std::uint32_t moved = graph.park(c.slot, end_of(on.bodies, a), end_of(on.bodies, b));
    if (moved != solve::kNoContact) pool[moved].slot = left;
    points -= c.count;
  } else {
    if (!is_still(on.bodies[a]) || !is_still(on.bodies[b])) return;
    const std::uint32_t slot = parked_speculative.add(speculative, c.speculative_index);
    unset_speculative(index);
    c.speculative_index = slot;
  }
  c.parked = true;
}

void ContactStore::unpark(std::uint32_t index, const BodySet& on) {
  Contact& c = pool[index];
  if (!c.parked) return;
  if (c.slot.points > 0) {
    const solve::ContactSlot left = c.slot;
    const std::uint32_t moved = graph.unpark(c.slot, end_of(on.bodies, on.colliders[c.a].body),
                                             end_of(on.bodies, on.colliders[c.b].body));
    if (moved != solve::kNoContact) pool[moved].slot = left;
    points += c.count;
  } else {
    const std::uint32_t slot = speculative.add(parked_speculative, c.speculative_index);
    unset_speculative(index);
    c.speculative_index = slot;
  }
  c.parked = false;
  if (c.dirty) mark_dirty(index);
}

void ContactStore::mark_dirty(std::uint32_t contact) {
  if (pool[contact].is_part()) contact = pool[contact].aggregate;
  pool[contact].dirty = true;
  dirty.push_back(contact);
}

void ContactStore::mark_contacts_dirty(const Body& body) {
  for_each_of(body, [&](std::uint32_t index, Contact&) { mark_dirty(index); });
}

void ContactStore::mark_dirty_slots(const solve::IndexField& contacts, std::uint32_t bits) {
  for (std::uint32_t b = bits; b != 0; b &= b - 1)
    prefetch_contact(contacts.lane[std::countr_zero(b)]);
  for (; bits != 0; bits &= bits - 1) {
    const std::uint32_t contact = contacts.lane[std::countr_zero(bits)];
    if (contact != solve::kNoContact) mark_dirty(contact);
  }
}

void ContactStore::mark_dirty_pairs(const solve::SpeculativeBlock& block, std::uint32_t bits) {
  for (std::uint32_t b = bits; b != 0; b &= b - 1)
    prefetch_contact(block.pairs[std::countr_zero(b)].contact);
  for (; bits != 0; bits &= bits - 1) {
    const std::uint32_t contact = block.pairs[std::countr_zero(bits)].contact;
    if (contact != solve::kNoContact) mark_dirty(contact);
  }
}

// The list is sorted by a bit set over the pool.
void ContactStore::set_dirty_bits() {
  dirty_bits_.resize(pool.capacity() / 64 + 1);
  for (const std::uint32_t i : dirty) dirty_bits_[i / 64] |= std::uint64_t{1} << (i % 64);
  dirty.clear();
}
void ContactStore::take_dirty_bits(std::vector<std::uint32_t>& ascending) {
  const std::size_t words = pool.size() / 64 + 1;
  for (std::size_t w = 0; w < words; ++w) {
    for (std::uint64_t left = std::exchange(dirty_bits_[w], 0); left != 0; left &= left - 1) {
      ascending.push_back(static_cast<std::uint32_t>(64 * w) +
                          static_cast<std::uint32_t>(std::countr_zero(left)));
    }
  }
}

}  // namespace vp
