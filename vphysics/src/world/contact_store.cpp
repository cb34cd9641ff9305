#include "world/contact_store.h"

#include <algorithm>
#include <bit>
#include <utility>

#include "solve/row_vector.h"

namespace vp {
namespace {

// What one of the two has gone by: at the centre of the ball in which they meet, and how far that
// may be off.
struct Gone {
  Vec3 displacement, turn;
  double bow;
};

}  // namespace

void ContactStore::reserve(std::size_t contacts) {
  pool.reserve(contacts);
  // Parts have contacts of their own.
  for (auto* list : {&free, &stale}) list->reserve(std::max(contacts, pool.capacity()));
  near.reserve(contacts);
}

void ContactStore::clear() {
  pool.clear();
  free.clear();
  graph.clear();
  near.clear();
  parked_near.clear();
  stale.clear();
  points = 0;
}

// In a slot of the pool and in its bodies' lists.
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
  if (c.place.points > 0) {
    take_out_of_lane(index, on);
  } else {
    unset_near(index);
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
  Contact& whole = pool[pool[index].whole];
  mark_stale(index);
  std::uint32_t* link = &whole.first_part;
  while (*link != index) link = &pool[*link].next_part;
  *link = pool[index].next_part;
  remove(index, on);
}

bool ContactStore::touches_in_parts(const Contact& whole) const {
  for (std::uint32_t p = whole.first_part; p != kNone; p = pool[p].next_part) {
    if (pool[p].touching) return true;
  }
  return false;
}

void ContactStore::put_in_lane(std::uint32_t index, int max_points, const BodySet& on) {
  Contact& c = pool[index];
  const std::uint32_t a = on.colliders[c.a].body, b = on.colliders[c.b].body;
  if (!c.is_part()) unset_near(index);
  c.place = graph.add(index, end_of(on.bodies, a), end_of(on.bodies, b), max_points);
  ++on.bodies[a].lanes;
  ++on.bodies[b].lanes;
}

void ContactStore::take_out_of_lane(std::uint32_t index, const BodySet& on) {
  Contact& c = pool[index];
  const std::uint32_t a = on.colliders[c.a].body, b = on.colliders[c.b].body;
  const std::uint32_t moved = graph.remove(c.place, end_of(on.bodies, a), end_of(on.bodies, b));
  if (moved != solve::kNoContact) pool[moved].place = c.place;
  c.place = {};
  if (!c.parked) points -= c.count;
  c.count = 0;
  --on.bodies[a].lanes;
  --on.bodies[b].lanes;
}

void ContactStore::follow_region(const Body& body, const BodySet& on) {
  for_each_of(body, [&](std::uint32_t, Contact& c) {
    if (c.place.points == 0 || c.parked) return;
    const solve::Place left = c.place;
    const std::uint32_t moved = graph.follow(c.place, end_of(on.bodies, on.colliders[c.a].body),
                                             end_of(on.bodies, on.colliders[c.b].body));
    if (moved != solve::kNoContact) pool[moved].place = left;
  });
}

void ContactStore::set_near(std::uint32_t index, double clearance, const BodySet& on) {
  Contact& c = pool[index];
  const std::uint32_t a = on.colliders[c.a].body, b = on.colliders[c.b].body;
  c.near_index = near.add(index, end_of(on.bodies, a).row, end_of(on.bodies, b).row);
  set_clearance(c, clearance, on);
}

void ContactStore::set_clearance(const Contact& c, double clearance, const BodySet& on) {
  solve::NearPair& pair = near.pair(c.near_index);
  const Collider &a = on.colliders[c.a], &b = on.colliders[c.b];
  const Vicinity at = vicinity_of(on.bodies, a, b);
  const auto put_end = [&](std::uint32_t row, const Body& body, float* x, float* turn, float* arm) {
    const float* way = on.rows[row].way;
    std::copy_n(way, 3, x);
    std::copy_n(way + 3, 3, turn);
    put(arm, row == solve::kWorldRow ? Vec3{} : at.centre - reference_point(body));
  };
  put_end(pair.a, on.bodies[a.body], pair.x_a, pair.turn_a, pair.arm_a);
  put_end(pair.b, on.bodies[b.body], pair.x_b, pair.turn_b, pair.arm_b);
  pair.clearance = static_cast<float>(clearance);
  pair.radius = static_cast<float>(at.radius);
}

void ContactStore::reset_near(const Contact& c, const BodySet& on) {
  set_clearance(c, c.of_link ? kNeverMeets : 0.0, on);
}

void ContactStore::unset_near(std::uint32_t index) {
  const std::uint32_t place = pool[index].near_index;
  const std::uint32_t moved = (pool[index].parked ? parked_near : near).remove(place);
  if (moved != solve::kNoContact) pool[moved].near_index = place;
}

double ContactStore::clearance(const Contact& c) const {
  return static_cast<double>(near.pair(c.near_index).clearance);
}

// As find_closer counts it.
void ContactStore::use_clearance(const Contact& c, const BodySet& on) {
  solve::NearPair& pair = near.pair(c.near_index);
  const auto gone = [&](std::uint32_t row, const float* x, const float* turn, const float* arm) {
    const float* way = on.rows[row].way;
    const Vec3 r = vector_of(arm), by = vector_of(way + 3) - vector_of(turn);
    return Gone{vector_of(way) - vector_of(x) + cross(by, r), by, 0.5 * dot(by, by) * norm(r)};
  };
  const Gone a = gone(pair.a, pair.x_a, pair.turn_a, pair.arm_a);
  const Gone b = gone(pair.b, pair.x_b, pair.turn_b, pair.arm_b);
  const double turned = static_cast<double>(pair.radius) * norm(b.turn - a.turn);
  pair.clearance -=
      static_cast<float>(norm(b.displacement - a.displacement) + turned + a.bow + b.bow);
}

// Unless something awake may change it: a near pair of which one is awake or kinematic. A kinematic
// body that touches one asleep rests; who sets it in motion wakes the other.
void ContactStore::park(std::uint32_t index, const BodySet& on) {
  Contact& c = pool[index];
  const std::uint32_t a = on.colliders[c.a].body, b = on.colliders[c.b].body;
  if (c.parked) return;
  if (c.place.points > 0) {
    const solve::Place left = c.place;
    const std::uint32_t moved = graph.park(c.place, end_of(on.bodies, a), end_of(on.bodies, b));
    if (moved != solve::kNoContact) pool[moved].place = left;
    points -= c.count;
  } else {
    if (!is_still(on.bodies[a]) || !is_still(on.bodies[b])) return;
    const std::uint32_t place = parked_near.add(near, c.near_index);
    unset_near(index);
    c.near_index = place;
  }
  c.parked = true;
}

void ContactStore::unpark(std::uint32_t index, const BodySet& on) {
  Contact& c = pool[index];
  if (!c.parked) return;
  if (c.place.points > 0) {
    const solve::Place left = c.place;
    const std::uint32_t moved = graph.unpark(c.place, end_of(on.bodies, on.colliders[c.a].body),
                                             end_of(on.bodies, on.colliders[c.b].body));
    if (moved != solve::kNoContact) pool[moved].place = left;
    points += c.count;
  } else {
    const std::uint32_t place = near.add(parked_near, c.near_index);
    unset_near(index);
    c.near_index = place;
  }
  c.parked = false;
  if (c.stale) mark_stale(index);
}

void ContactStore::mark_stale(std::uint32_t contact) {
  if (pool[contact].is_part()) contact = pool[contact].whole;
  pool[contact].stale = true;
  stale.push_back(contact);
}

void ContactStore::mark_stale_of(const Body& body) {
  for_each_of(body, [&](std::uint32_t index, Contact&) { mark_stale(index); });
}

void ContactStore::mark_stale_lanes(const solve::IndexField& contacts, std::uint32_t bits) {
  for (; bits != 0; bits &= bits - 1) {
    const std::uint32_t contact = contacts.lane[std::countr_zero(bits)];
    if (contact != solve::kNoContact) mark_stale(contact);
  }
}

void ContactStore::mark_stale_pairs(const solve::NearBlock& block, std::uint32_t bits) {
  for (; bits != 0; bits &= bits - 1) {
    const std::uint32_t contact = block.pairs[std::countr_zero(bits)].contact;
    if (contact != solve::kNoContact) mark_stale(contact);
  }
}

// By a bit for each of the pool.
void ContactStore::take_stale(std::vector<std::uint32_t>& ascending) {
  stale_bits_.resize(pool.capacity() / 64 + 1);
  for (const std::uint32_t i : stale) stale_bits_[i / 64] |= std::uint64_t{1} << (i % 64);
  stale.clear();
  ascending.clear();
  const std::size_t words = pool.size() / 64 + 1;
  for (std::size_t w = 0; w < words; ++w) {
    for (std::uint64_t left = std::exchange(stale_bits_[w], 0); left != 0; left &= left - 1) {
      ascending.push_back(static_cast<std::uint32_t>(64 * w) +
                          static_cast<std::uint32_t>(std::countr_zero(left)));
    }
  }
}

}  // namespace vp
