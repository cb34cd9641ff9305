#include "world/contact_state.h"

#include <algorithm>

#include "collide/manifolds.h"

namespace vp {

void ContactState::clear() {
  contacts_.clear();
  regions_.axes.clear();
  regions_.age = 0.0;
}

void ContactState::read(Reader& in) {
  clear();
  world_.finder.read(in);
  in.check(world_.finder.incoming_fits());
  bodies_.assign(world_.bodies.size(), {});
  for (std::size_t i = 0; i < bodies_.size(); ++i) {
    read_body(in, bodies_[i]);
    const Body& body = world_.bodies[i];
    in.check(!bodies_[i].asleep || (body.motion == Motion::dynamic && !body.is_link &&
                                    !body.continuous && body.allow_sleep));
  }
  read_pool(in);
  for (std::uint32_t i = 0; i < bodies_.size() && in.ok(); ++i) read_edges(in, i);
  for (std::size_t i = 0; i < contacts_.pool.size(); ++i)
    in.check(!contacts_.pool[i].alive || (seen_[i] & 3u) == 3u);
  if (!in.ok()) return;
  const std::size_t free = in.count(1);
  for (std::size_t i = 0; i < free && in.ok(); ++i) {
    const std::uint32_t c = in.index(contacts_.pool.size());
    if (!in.ok()) return;
    in.check(!contacts_.pool[c].alive && seen_[c] == 0);
    seen_[c] = 8;
    contacts_.free.push_back(c);
  }
  read_speculative(in, contacts_.speculative, false);
  read_speculative(in, contacts_.parked_speculative, true);
  contacts_.graph.resize(world_.bodies.size() + 1);
  read_regions(in);
  for (std::size_t region = 0; region < contacts_.graph.regions(); ++region) {
    for (int c = 0; c <= solve::kParked && in.ok(); ++c) {
      read_slots<1>(in, region, c);
      read_slots<4>(in, region, c);
    }
  }
  for (std::size_t i = 0; i < contacts_.pool.size(); ++i) {
    in.check((seen_[i] & 15u) == (contacts_.pool[i].alive ? 7u : 8u));
  }
}

void ContactState::read_body(Reader& in, OfBody& body) {
  const std::uint64_t flags = in.u64();
  in.check(flags <= 3);
  body.supported = (flags & 1u) != 0;
  body.asleep = (flags & 2u) != 0;
  body.rest_time = in.number();
  for (int k = 0; k < 6; ++k) {
    const Reader::TwoFloats both = in.two_floats();
    body.displacement[k] = both.high;
    body.bounded_at[k] = both.low;
  }
}

void ContactState::read_pool(Reader& in) {
  using namespace contact_flags;
  contacts_.pool.resize(in.count(1));
  seen_.assign(contacts_.pool.size(), 0);
  for (Contact& c : contacts_.pool) {
    if (!in.ok()) return;
    const std::uint64_t flags = in.u64();
    const std::uint64_t kinds = flags & (kHasParts | kIsPart);
    in.check(flags <= kAll && ((flags & kAlive) != 0 || flags == 0) &&
             kinds != (kHasParts | kIsPart));
    c.alive = (flags & kAlive) != 0;
    c.sensor = (flags & kSensor) != 0;
    c.touching = (flags & kTouching) != 0;
    c.dirty = (flags & kDirty) != 0;
    c.of_link = (flags & kOfLink) != 0;
    c.has_parts = (flags & kHasParts) != 0;
    if (c.alive && in.ok()) read_contact(in, c, (flags & kIsPart) != 0);
  }
  check_parts(in);
}

// Each part is in the chain of its aggregate, exactly once.
void ContactState::check_parts(Reader& in) {
  for (std::uint32_t i = 0; i < contacts_.pool.size() && in.ok(); ++i) {
    const Contact& aggregate = contacts_.pool[i];
    if (!aggregate.alive || !aggregate.has_parts) continue;
    for (std::uint32_t p = aggregate.first_part; p != kNone && in.ok();
         p = contacts_.pool[p].next_part) {
      in.check(p < contacts_.pool.size());
      if (!in.ok()) return;
      const Contact& part = contacts_.pool[p];
      in.check(part.alive && part.aggregate == i && part.key == aggregate.key && seen_[p] == 0 &&
               !aggregate.sensor && !aggregate.of_link);
      seen_[p] = 16;
    }
  }
  for (std::size_t i = 0; i < contacts_.pool.size(); ++i) {
    in.check((seen_[i] & 16u) != 0 || !contacts_.pool[i].alive || !contacts_.pool[i].is_part());
  }
}

void ContactState::read_contact(Reader& in, Contact& c, bool is_part) {
  const Colliders& all = world_.colliders;
  c.key = in.u64();
  const Reader::Two both = in.two();
  c.a = both.high;
  c.b = both.low;
  in.check(c.a < all.size() && c.b < all.size() && c.a != c.b);
  if (!in.ok()) return;
  const Collider &a = all[c.a], &b = all[c.b];
  in.check(a.alive && b.alive && a.serial < b.serial && make_pair(all, c.a, c.b).key == c.key &&
           c.sensor == (a.sensor || b.sensor));
  const Reader::TwoFloats xy = in.two_floats();
  const Reader::Two z = in.two(), ij = in.two();
  c.cache.normal[0] = xy.high;
  c.cache.normal[1] = xy.low;
  c.cache.normal[2] = std::bit_cast<float>(z.high);
  in.check(std::isfinite(c.cache.normal[2]) && z.low <= 0xff && ij.high <= 0xffff &&
           ij.low <= 0xffff);
  c.cache.feature = static_cast<std::uint8_t>(z.low);
  c.cache.i = static_cast<std::uint16_t>(ij.high);
  c.cache.j = static_cast<std::uint16_t>(ij.low);
  in.check((c.has_parts || is_part) == has_parts(a.geometry, b.geometry));
  in.check(!(is_part && c.dirty));
  if (c.has_parts) c.first_part = in.two().high;
  if (is_part) {
    const Reader::Two chain = in.two(), subs = in.two();
    c.aggregate = chain.high;
    c.next_part = chain.low;
    c.sub_a = subs.high;
    c.sub_b = subs.low;
    in.check(c.aggregate < contacts_.pool.size() && c.sub_a < number_of_parts(a.geometry) &&
             c.sub_b < number_of_parts(b.geometry));
  }
  const std::uint64_t count = in.u64();
  in.check(count <= collide::kMaxPoints && (count == 0 || !c.has_parts) && (count > 0 || !is_part));
  if (!in.ok()) return;
  const Body &body_a = world_.bodies[a.body], &body_b = world_.bodies[b.body];
  in.check(c.of_link == (body_a.is_link || body_b.is_link) && !body_a.continuous &&
           !body_b.continuous && (count == 0 || !(c.sensor || c.of_link)) &&
           !never_collide(body_a, body_b));
  c.count = static_cast<std::uint8_t>(count);
  for (int i = 0; i < c.count; ++i) {
    const std::uint64_t feature = in.u64();
    in.check(feature <= 0xffffffffu);
    c.feature[i] = static_cast<std::uint32_t>(feature);
    c.position[i] = in.finite_vector();
  }
}

// In list order; each side of a contact once.
void ContactState::read_edges(Reader& in, std::uint32_t body) {
  const std::size_t count = in.count(1);
  std::uint32_t previous = kNone;
  for (std::size_t i = 0; i < count && in.ok(); ++i) {
    const std::uint32_t e = in.index(2 * contacts_.pool.size());
    if (!in.ok()) return;
    Contact& c = contacts_.pool[e / 2];
    const auto side = static_cast<std::uint8_t>(1u << (e % 2));
    const bool own = c.alive && world_.colliders[e % 2 == 0 ? c.a : c.b].body == body;
    in.check(own && (seen_[e / 2] & side) == 0);
    in.check(!c.is_part() || (seen_[c.aggregate] & side) == 0);  // no part follows its aggregate
    if (!in.ok()) return;
    seen_[e / 2] = static_cast<std::uint8_t>(seen_[e / 2] | side);
    c.previous[e % 2] = previous;
    c.next[e % 2] = kNone;
    (previous == kNone ? bodies_[body].first_edge
                       : contacts_.pool[previous / 2].next[previous % 2]) = e;
    previous = e;
  }
}

void ContactState::read_speculative(Reader& in, solve::SpeculativeList& speculative, bool parked) {
  const std::size_t count = in.count(1);
  for (std::size_t i = 0; i < count && in.ok(); ++i) {
    const std::uint32_t index = in.index(contacts_.pool.size());
    if (!in.ok()) return;
    Contact& c = contacts_.pool[index];
    in.check(c.alive && c.count == 0 && (seen_[index] & 4u) == 0);  // so it is no part
    seen_[index] = static_cast<std::uint8_t>(seen_[index] | 4u);
    c.parked = parked;
    c.speculative_index =
        speculative.add(index, vp::end_of(world_.bodies, world_.colliders[c.a].body).state,
                        vp::end_of(world_.bodies, world_.colliders[c.b].body).state);
    solve::SpeculativePair& pair = speculative.pair(c.speculative_index);
    for (std::size_t f = 0; f < solve::kSpeculativeFloats; f += 2) {
      const Reader::TwoFloats both = in.two_floats();
      solve::set_near_float(pair, f, both.high);
      if (f + 1 < solve::kSpeculativeFloats) solve::set_near_float(pair, f + 1, both.low);
    }
  }
}

void ContactState::read_fields(Reader& in, std::span<solve::Field> fields, int lane) {
  for (std::size_t f = 0; f < fields.size(); f += 2) {
    const Reader::TwoFloats both = in.two_floats();
    fields[f].lane[lane] = both.high;
    if (f + 1 < fields.size()) fields[f + 1].lane[lane] = both.low;
  }
}

void ContactState::read_regions(Reader& in) {
  const std::uint32_t count = in.index(kMaxRegions + 1);
  in.check(count == 0 || (std::has_single_bit(count) && count > 1));
  regions_.age = in.number();
  in.check(regions_.age >= 0.0);
  if (!in.ok() || count == 0) return;
  regions_.axes.resize(count);
  for (std::uint8_t& axis : regions_.axes) axis = static_cast<std::uint8_t>(in.index(kNoAxis + 1));
  for (OfBody& body : bodies_) body.region = static_cast<std::uint16_t>(in.index(count + 1));
  if (in.ok()) contacts_.graph.set_regions(std::size_t{count} + 1);
}

solve::ContactGraph::End ContactState::end_of(std::uint32_t body) const {
  solve::ContactGraph::End end = vp::end_of(world_.bodies, body);
  end.region = bodies_[body].region;
  return end;
}

template <int P>
void ContactState::read_slots(Reader& in, std::size_t region, int colour) {
  constexpr std::size_t kFields = solve::kFieldsOf<P>;
  const std::size_t slots = in.count(1 + kFields / 2);
  for (std::size_t l = 0; l < slots && in.ok(); ++l) {
    const std::uint32_t index = in.index(contacts_.pool.size());
    if (!in.ok()) return;
    Contact& c = contacts_.pool[index];
    in.check(c.alive && c.count > 0 && c.count <= P && (seen_[index] & 4u) == 0);
    if (!in.ok()) return;
    seen_[index] = static_cast<std::uint8_t>(seen_[index] | 4u);
    const std::uint32_t a = world_.colliders[c.a].body, b = world_.colliders[c.b].body;
    in.check(contacts_.graph.append(index, end_of(a), end_of(b), P, colour, c.slot) &&
             c.slot.region == region);
    if (!in.ok()) return;
    ++bodies_[a].contact_slots;
    ++bodies_[b].contact_slots;
    const int lane = solve::ContactGraph::lane(c.slot);
    contacts_.graph.block<P>(c.slot).touches.lane[lane] = c.touching ? 1 : 0;
    contacts_.graph.block<P>(c.slot).active.lane[lane] = 1.0f;
    read_fields(in, solve::fields_of(contacts_.graph.block<P>(c.slot)), lane);
    c.parked = colour == solve::kParked;
    if (!c.parked) contacts_.points += c.count;
  }
}

void ContactState::adopt() {
  world_.finder.adopt();
  world_.body_states.resize(bodies_.size() + 1);
  for (std::size_t i = 0; i < bodies_.size(); ++i) {
    Body& body = world_.bodies[i];
    const OfBody& from = bodies_[i];
    body.supported = from.supported;
    if (body.asleep != from.asleep || body.region != from.region) world_.lists.invalidate();
    body.asleep = from.asleep;
    body.rest_time = from.rest_time;
    if (body.asleep) std::fill_n(world_.body_states[i + 1].velocity, 6, 0.0f);
    body.first_edge = from.first_edge;
    body.contact_slots = from.contact_slots;
    body.region = from.region;
    std::copy_n(from.displacement, 6, world_.body_states[i + 1].displacement);
    std::copy_n(from.bounded_at, 6, body.bounded_at);
  }
  for (std::uint32_t i = 0; i < contacts_.pool.size(); ++i) {
    const Contact& c = contacts_.pool[i];
    if (c.alive && c.dirty && !c.parked) contacts_.dirty.push_back(i);
  }
  if (world_.contacts.graph.regions() != contacts_.graph.regions()) {
    world_.lists.invalidate();
  }
  std::swap(world_.contacts, contacts_);
  regions_.count = static_cast<std::uint16_t>(world_.contacts.graph.regions() - 1);
  std::swap(world_.regions, regions_);
}

}  // namespace vp
