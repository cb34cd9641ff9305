// The contacts of a world: a pool of them, a list for each body, and where each is kept for the
// solver: in a lane of the contact graph if it has points, else in a near list, which tells when
// the two have come so close that the narrow phase must look again.
#pragma once

#include <cstdint>
#include <vector>

#include "solve/body_row.h"
#include "solve/contact_graph.h"
#include "solve/large_pages.h"
#include "solve/speculative_list.h"
#include "world/collider.h"
#include "world/contact.h"

namespace vp {

// What contacts are between; rows: 0 is of the world, i + 1 of body i.
struct BodySet {
  Bodies& bodies;
  Colliders& colliders;
  solve::LargeVector<solve::BodyRow>& rows;
};

class ContactStore {
 public:
  // --- state
  std::vector<Contact> pool;
  std::vector<std::uint32_t> free;
  solve::ContactGraph graph;                  // of those that have points
  solve::SpeculativeList speculative;         // of those that have none
  solve::SpeculativeList parked_speculative;  // and of those of them that are of bodies asleep
  // Those marked as stale, in no order, and with others that are not any more.
  std::vector<std::uint32_t> dirty;
  std::uint32_t points = 0;  // in lanes that are not parked

  Contact& operator[](std::uint32_t contact) { return pool[contact]; }
  const Contact& operator[](std::uint32_t contact) const { return pool[contact]; }
  void reserve(std::size_t contacts);
  void clear();  // memory stays

  // f(number, contact) of all contacts of a body. It may remove that one.
  template <class F>
  void for_each_of(const Body& body, const F& f) {
    for (std::uint32_t e = body.first_edge, next = kNone; e != kNone; e = next) {
      next = pool[e / 2].next[e % 2];
      f(e / 2, pool[e / 2]);
    }
  }
  bool touches_in_parts(const Contact& aggregate) const;

  // A new one, in no lane and in no near list.
  std::uint32_t add(const Contact& contact, const BodySet& on);
  // With its parts.
  void remove(std::uint32_t contact, const BodySet& on);
  void remove_parts(std::uint32_t aggregate, const BodySet& on);
  // One of several: the whole has to be looked at again.
  void forget_part(std::uint32_t part, const BodySet& on);

  // --- lanes. An empty one for so many points: it leaves its near list.
  void assign_slot(std::uint32_t contact, int max_points, const BodySet& on);
  void release_slot(std::uint32_t contact, const BodySet& on);
  // To the regions that the body's contacts are in now.
  void follow_region(const Body& body, const BodySet& on);

  // --- near lists. It is free of contact for so far [m] from where its bodies are now.
  void set_speculative(std::uint32_t contact, double clearance, const BodySet& on);
  void set_clearance(const Contact& contact, double clearance, const BodySet& on);
  double clearance(const Contact& contact) const;
  // To be looked at; of a link, elsewhere.
  void reset_speculative(const Contact& contact, const BodySet& on);
  // Takes from the clearance how far the two have gone against each other since it was set.
  void use_clearance(const Contact& contact, const BodySet& on);

  // --- sleep
  void park(std::uint32_t contact, const BodySet& on);
  void unpark(std::uint32_t contact, const BodySet& on);

  // --- the narrow phase must look at it again; of a part, at the whole.
  void mark_dirty(std::uint32_t contact);
  void mark_contacts_dirty(const Body& body);
  void mark_dirty_slots(const solve::IndexField& contacts, std::uint32_t bits);
  void mark_stale_pairs(const solve::SpeculativeBlock& speculative, std::uint32_t bits);
  // The stale ones, ascending, each once; then none is.
  void take_dirty(std::vector<std::uint32_t>& ascending);

 private:
  void unset_speculative(std::uint32_t contact);

  std::vector<std::uint64_t> dirty_bits_;  // scratch
};

inline constexpr double kNeverTouches = 1e30;  // a clearance [m]

}  // namespace vp
