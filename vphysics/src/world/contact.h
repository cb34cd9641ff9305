// A pair of colliders that are near one another, for as long as their enlarged bounds overlap.
//
// The narrow phase looks at it only when the two may have moved by more than a little against each
// other since it last did (find_contacts.cpp). What it finds lives in a lane of the solver's
// blocks.
//
// Of a pair in which a mesh, a height field or a compound takes part, a contact stands for the
// whole: it is always among those without points. For each manifold it has another contact, a part,
// which is in a lane (part_contacts.cpp).
#pragma once

#include <cstdint>

#include "collide/manifold.h"
#include "solve/contact_graph.h"

namespace vp {

struct Contact {
  static constexpr std::uint32_t kNoContact = 0xffffffffu;

  std::uint64_t key = 0;       // serials of both
  std::uint32_t a = 0, b = 0;  // colliders, in order of creation
  // Neighbours in the lists of their bodies: side 0 in that of a's, 1 in that of b's. An edge is
  // 2 * contact + side.
  std::uint32_t next[2] = {}, previous[2] = {};
  bool alive = false;
  bool sensor = false;
  bool of_link = false;  // one of the two is of a link: never in a lane (link_contacts.cpp)
  bool touching = false;
  bool parked = false;  // of bodies that are asleep
  bool dirty = true;    // must be looked at in the next step, wherever the two are
  solve::ContactSlot slot;
  collide::PairCache cache;  // of the narrow phase

  bool has_parts = false;                 // it is the whole
  std::uint32_t first_part = kNoContact;  // of them, in the order of the narrow phase
  // Of a part: the whole, the next one, and which parts of the shapes touch.
  std::uint32_t aggregate = kNoContact, next_part = kNoContact;
  std::uint32_t sub_a = 0, sub_b = 0;
  bool is_part() const { return aggregate != kNoContact; }

  // Points, if it has any.
  std::uint8_t count = 0;
  std::uint32_t feature[collide::kMaxPoints] = {};
  Vec3 position[collide::kMaxPoints] = {};  // world frame, when they were found

  std::uint32_t speculative_index = 0;  // if it has none: its lane in the near list
};

}  // namespace vp
