// A contact: a pair of colliders whose enlarged bounds overlap, for as long as they do.
//
// The narrow phase tests it again only when the two may have moved relative to each other by more
// than a small amount since the last test (find_contacts.cpp). The resulting manifold is in a
// contact slot of the solver's blocks.
//
// A pair with a mesh, a height field or a compound has an aggregate contact, which never has points
// of its own. Each manifold of the pair has a contact too, a part, in a contact slot
// (part_contacts.cpp).
#pragma once

#include <cstdint>

#include "collide/manifold.h"
#include "solve/contact_graph.h"

namespace vp {

struct Contact {
  static constexpr std::uint32_t kNoContact = 0xffffffffu;

  std::uint64_t key = 0;       // serials of both
  std::uint32_t a = 0, b = 0;  // colliders, in order of creation
  // Links of the bodies' lists of contacts: side 0 in the list of a's body, 1 in that of b's. An
  // edge is 2 * contact + side.
  std::uint32_t next[2] = {}, previous[2] = {};
  bool alive = false;
  bool sensor = false;
  bool of_link = false;  // one of the two is of a link: never in a contact slot (link_contacts.cpp)
  bool touching = false;
  bool parked = false;     // of sleeping bodies
  bool dirty = true;       // the next step must test it, however little the two have moved
  bool has_parts = false;  // it is an aggregate contact
  std::uint8_t count = 0;  // of its contact points
  solve::ContactSlot slot;
  std::uint32_t speculative_index = 0;    // without points: its index in the speculative list
  std::uint32_t first_part = kNoContact;  // of its parts, in the order of the narrow phase
  // Of a part: its aggregate, the next part, and the indices of the shapes' parts.
  std::uint32_t aggregate = kNoContact, next_part = kNoContact;
  std::uint32_t sub_a = 0, sub_b = 0;
  collide::PairCache cache;  // of the narrow phase

  // Of its contact points.
  std::uint32_t feature[collide::kMaxPoints] = {};
  Vec3 position[collide::kMaxPoints] = {};  // world frame, when the narrow phase found them

  bool is_part() const { return aggregate != kNoContact; }
};

}  // namespace vp
