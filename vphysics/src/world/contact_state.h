// The complete contact state of a world between steps, as 64-bit words.
//
// broad phase     pair_finder.h
// bodies          of each: flags (supported, asleep); how long at rest; displacement of its state
//                 and displacement at its last bounds
// pool            of each entry its flags, and if it is alive the contact, with the chain of its
//                 parts
// body contacts   of each body: its contacts, in order, as edges (2 contact + side)
// free entries    of the pool, in order
// speculative     the list in order, then the parked one: each contact and all its fields
// regions         how many; time since the last division; the axis of each split; of each body
//                 its region
// contact slots   of each region and colour, then of the parked ones, and each kind: how many,
//                 and of each its contact and all its fields
//
// Derived data are not written: list neighbours, state indices of the contact slots, colours in
// use.
#pragma once

#include <vector>

#include "collide/pair_finder.h"
#include "solve/large_pages.h"
#include "world/body.h"
#include "world/collider.h"
#include "world/contact_store.h"
#include "world/regions.h"
#include "world/snapshot_io.h"

namespace vp {

// The data that are written and read.
struct ContactData {
  Bodies& bodies;
  Colliders& colliders;
  solve::LargeVector<solve::BodyState>& body_states;
  collide::PairFinder& finder;
  ContactStore& contacts;
  Regions::State& regions;
  BodyLists& lists;
};

// State read from bytes and checked before the world adopts it. Reused for its memory: adopt()
// swaps.
class ContactState {
 public:
  explicit ContactState(const ContactData& world) : world_(world) {}
  void read(Reader& in);
  // Precondition: the reader was ok after read().
  void adopt();

 private:
  struct OfBody {
    bool supported = false, asleep = false;
    double rest_time = 0.0;
    float displacement[6] = {}, bounded_at[6] = {};
    std::uint32_t first_edge = kNone, contact_slots = 0;
    std::uint16_t region = solve::kSharedRegion;
  };
  void clear();
  void read_body(Reader& in, OfBody& body);
  void read_contact(Reader& in, Contact& contact, bool is_part);
  void read_pool(Reader& in);
  void check_parts(Reader& in);
  void read_edges(Reader& in, std::uint32_t body);
  void read_speculative(Reader& in, solve::SpeculativeList& speculative, bool parked);
  static void read_fields(Reader& in, std::span<solve::Field> fields, int lane);
  void read_regions(Reader& in);
  solve::ContactGraph::End end_of(std::uint32_t body) const;
  template <int P>
  void read_slots(Reader& in, std::size_t region, int colour);

  const ContactData world_;
  std::vector<OfBody> bodies_;
  ContactStore contacts_;
  // Flags of each contact: where it was found. 1, 2: lists of its two sides; 4: a speculative list
  // or a contact slot; 8: free; 16: its aggregate's chain of parts.
  std::vector<std::uint8_t> seen_;
  Regions::State regions_;
};

namespace contact_flags {
inline constexpr std::uint32_t kAlive = 1, kSensor = 2, kTouching = 4, kDirty = 8, kOfLink = 16,
                               kHasParts = 32, kIsPart = 64, kAll = 127;
}

template <class Sink>
void write_contacts(Sink& sink, const ContactData& world) {
  world.finder.write(sink);
  static const solve::BodyState kNoState{};
  for (std::uint32_t i = 0; i < world.bodies.size(); ++i) {
    const Body& body = world.bodies[i];
    const solve::BodyState& state =
        i + 1 < world.body_states.size() ? world.body_states[i + 1] : kNoState;
    sink.u64((body.supported ? 1u : 0u) | (body.asleep ? 2u : 0u));
    put(sink, body.rest_time);
    for (int k = 0; k < 6; ++k) put_two(sink, state.displacement[k], body.bounded_at[k]);
  }
  sink.u64(world.contacts.pool.size());
  for (const Contact& c : world.contacts.pool) {
    using namespace contact_flags;
    const std::uint32_t flags = (c.alive ? kAlive : 0) | (c.sensor ? kSensor : 0) |
                                (c.touching ? kTouching : 0) | (c.dirty ? kDirty : 0) |
                                (c.of_link ? kOfLink : 0) | (c.has_parts ? kHasParts : 0) |
                                (c.is_part() ? kIsPart : 0);
    sink.u64(c.alive ? flags : 0);
    if (!c.alive) continue;
    sink.u64(c.key);
    put_two(sink, c.a, c.b);
    put_two(sink, c.cache.normal[0], c.cache.normal[1]);
    put_two(sink, std::bit_cast<std::uint32_t>(c.cache.normal[2]), std::uint32_t{c.cache.feature});
    put_two(sink, std::uint32_t{c.cache.i}, std::uint32_t{c.cache.j});
    if (c.has_parts) put_two(sink, c.first_part, 0u);
    if (c.is_part()) {
      put_two(sink, c.aggregate, c.next_part);
      put_two(sink, c.sub_a, c.sub_b);
    }
    sink.u64(c.count);
    for (int i = 0; i < c.count; ++i) {
      sink.u64(c.feature[i]);
      put(sink, c.position[i]);
    }
  }
  for (const Body& body : world.bodies) {
    std::uint64_t count = 0;
    const auto for_edges = [&](const auto& f) {
      for (std::uint32_t e = body.first_edge; e != kNone;
           e = world.contacts.pool[e / 2].next[e % 2])
        f(e);
    };
    for_edges([&](std::uint32_t) { ++count; });
    sink.u64(count);
    for_edges([&](std::uint32_t e) { sink.u64(e); });
  }
  sink.u64(world.contacts.free.size());
  for (const std::uint32_t c : world.contacts.free) sink.u64(c);
  const auto write_fields = [&sink](const auto& fields, int lane) {
    for (std::size_t f = 0; f < fields.size(); f += 2) {
      put_two(sink, fields[f].lane[lane], f + 1 < fields.size() ? fields[f + 1].lane[lane] : 0.0f);
    }
  };
  for (const solve::SpeculativeList* list :
       {&world.contacts.speculative, &world.contacts.parked_speculative}) {
    sink.u64(list->size());
    for (std::uint32_t i = 0; i < list->size(); ++i) {
      const solve::SpeculativePair& pair = list->pair(i);
      sink.u64(pair.contact);
      for (std::size_t f = 0; f < solve::kSpeculativeFloats; f += 2) {
        const bool is_last = f + 1 == solve::kSpeculativeFloats;
        put_two(sink, solve::near_float(pair, f), is_last ? 0.0f : solve::near_float(pair, f + 1));
      }
    }
  }
  sink.u64(world.regions.count);
  put(sink, world.regions.age);
  for (const std::uint8_t axis : world.regions.axes) sink.u64(axis);
  if (world.regions.count > 0) {
    for (const Body& body : world.bodies) sink.u64(body.region);
  }
  const auto write_slots = [&](const auto& colour, int index) {
    sink.u64(colour.slots);
    for (std::uint32_t l = 0; l < colour.slots; ++l) {
      const auto& block = colour.blocks[colour.block_of(l, index)];
      const int lane = colour.lane_of(l, index);
      sink.u64(block.contact.lane[lane]);
      write_fields(solve::fields_of(block), lane);
    }
  };
  for (std::size_t region = 0; region < world.contacts.graph.regions(); ++region) {
    for (int c = 0; c <= solve::kParked; ++c) {
      write_slots(world.contacts.graph.of<1>(region, c), c);
      write_slots(world.contacts.graph.of<4>(region, c), c);
    }
  }
}

}  // namespace vp
