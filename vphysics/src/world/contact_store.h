// The contacts of a world: a pool, a list for each body, and their storage for the solver. A
// contact with points has a slot in the contact graph. A contact without points is in a speculative
// list, which detects when the two have come so close that the narrow phase must test them again.
#pragma once

#include <cstdint>
#include <vector>

#include "solve/body_state.h"
#include "solve/contact_graph.h"
#include "solve/large_pages.h"
#include "solve/speculative_list.h"
#include "world/collider.h"
#include "world/contact.h"

namespace vp {

// The objects that contacts refer to. State 0 is the world, state i + 1 is of body i.
struct BodySet {
  Bodies& bodies;
  Colliders& colliders;
  solve::LargeVector<solve::BodyState>& states;
};

// A pair cannot touch before its bodies have come nearer to each other by the distance.
struct Clearance {
  double distance = 0.0;  // [m]
  Vec3 normal = {};       // along it, from a to b; zero: moved relative to each other so far
  // Between spheres about the bodies' reference points: rotation brings nothing nearer.
  bool of_spheres = false;
};

inline constexpr double kNeverTouches = 1e30;  // clearance of a pair that cannot touch [m]

class ContactStore {
 public:
  // --- state
  solve::LargeVector<Contact> pool;
  std::vector<std::uint32_t> free;
  solve::ContactGraph graph;                  // contacts with points
  solve::SpeculativeList speculative;         // contacts without points
  solve::SpeculativeList parked_speculative;  // the same, of sleeping bodies
  // Dirty contacts, in no order; may include some that are no longer dirty.
  std::vector<std::uint32_t> dirty;
  std::uint32_t points = 0;  // in contact slots that are not parked

  Contact& operator[](std::uint32_t contact) { return pool[contact]; }
  const Contact& operator[](std::uint32_t contact) const { return pool[contact]; }
  void reserve(std::size_t contacts);
  void clear();  // keeps the memory

  // Calls f(index, contact) for each contact of a body. f may remove that contact.
  template <class F>
  void for_each_of(const Body& body, const F& f) {
    for (std::uint32_t e = body.first_edge, next = kNone; e != kNone; e = next) {
      next = pool[e / 2].next[e % 2];
      if (next != kNone) __builtin_prefetch(&pool[next / 2]);
      f(e / 2, pool[e / 2]);
    }
  }
  // Before each speculative pair of a body is accessed: requests them all at once.
  void prefetch_speculative(const Body& body) const {
    for (std::uint32_t e = body.first_edge; e != kNone; e = pool[e / 2].next[e % 2]) {
      const Contact& c = pool[e / 2];
      if (c.slot.points > 0 || c.parked) continue;
      const auto* pair = reinterpret_cast<const char*>(&speculative.pair(c.speculative_index));
      __builtin_prefetch(pair);
      __builtin_prefetch(pair + sizeof(solve::SpeculativePair) - 1);
    }
  }
  bool touches_in_parts(const Contact& aggregate) const;

  // A new contact, in no slot and no speculative list.
  std::uint32_t add(const Contact& contact, const BodySet& on);
  // With its parts.
  void remove(std::uint32_t contact, const BodySet& on);
  void remove_parts(std::uint32_t aggregate, const BodySet& on);
  // Removes one of several parts and marks the aggregate dirty.
  void forget_part(std::uint32_t part, const BodySet& on);

  // The states of its two bodies.
  struct States {
    std::uint32_t a, b;
  };
  States states_of(const Contact& contact) const;

  // --- contact slots
  // Assigns a slot for up to max_points points; the contact leaves its speculative list.
  void assign_slot(std::uint32_t contact, int max_points, const BodySet& on);
  void release_slot(std::uint32_t contact, const BodySet& on);
  // The pass that looks for moved slots finds this one, however little it has moved.
  void mark_moved(const Contact& contact);
  // Moves the body's contacts to the regions that they are in now.
  void follow_region(const Body& body, const BodySet& on);

  // --- speculative lists
  void set_speculative(std::uint32_t contact, const Clearance& clearance, const BodySet& on);
  void set_clearance(const Contact& contact, const Clearance& clearance, const BodySet& on);
  // Sets the clearance to zero, so that it is tested; of links, which are tested elsewhere, to
  // never.
  void reset_speculative(const Contact& contact, const BodySet& on);
  // Sets the clearance to what is left of it at the present displacements, in all directions. False
  // if nothing is.
  bool use_clearance(const Contact& contact, const BodySet& on);

  // The displacement of a state has restarted at zero, from `displacement`: the pair goes on from
  // there, and its clearance may be used up. False if its sums of displacements or rotations have
  // become too long: then its clearance must be set again.
  bool follow_restart(const Contact& contact, std::uint32_t state, const float* displacement);

  // Whether the two may touch within this time from now [s], at the states' present velocities.
  bool may_touch_within(const Contact& contact, double time, const BodySet& on) const;

  // --- sleep
  void park(std::uint32_t contact, const BodySet& on);
  void unpark(std::uint32_t contact, const BodySet& on);

  // --- dirty contacts
  // The narrow phase must test the contact again; of a part, its aggregate.
  void mark_dirty(std::uint32_t contact);
  void mark_contacts_dirty(const Body& body);
  void mark_dirty_slots(const solve::IndexField& contacts, std::uint32_t bits);
  void mark_dirty_pairs(const solve::SpeculativeBlock& block, std::uint32_t bits);
  // Returns the dirty ones, each once, and clears the list: first those in slots, in the order in
  // which for_each_block passes blocks' contact indices to its argument, then all others,
  // ascending.
  template <class F>
  void take_dirty(std::vector<std::uint32_t>& taken, const F& for_each_block) {
    taken.clear();
    const bool some = !dirty.empty();
    set_dirty_bits();
    if (!some) return;
    for_each_block([&](const solve::IndexField& contacts) {
      for (const std::uint32_t i : contacts.lane) {
        if (i == solve::kNoContact || !is_dirty_bit_set(i)) continue;
        clear_dirty_bit(i);
        taken.push_back(i);
      }
    });
    take_dirty_bits(taken);
  }
  void take_dirty(std::vector<std::uint32_t>& ascending) {
    take_dirty(ascending, [](const auto&) {});
  }

 private:
  void prefetch_contact(std::uint32_t contact) const {
    if (contact < pool.size()) __builtin_prefetch(&pool[contact], 1);
  }
  bool is_dirty_bit_set(std::uint32_t i) const {
    return (dirty_bits_[i / 64] >> (i % 64) & 1u) != 0;
  }
  void clear_dirty_bit(std::uint32_t i) { dirty_bits_[i / 64] &= ~(std::uint64_t{1} << (i % 64)); }
  void set_dirty_bits();
  void take_dirty_bits(std::vector<std::uint32_t>& ascending);
  void unset_speculative(std::uint32_t contact);

  std::vector<std::uint64_t> dirty_bits_;  // scratch
};

}  // namespace vp
