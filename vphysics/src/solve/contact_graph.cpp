#include "solve/contact_graph.h"

#include <algorithm>
#include <cmath>

#include "solve/body_state.h"
#include "solve/slot_copy.h"

namespace vp::solve {
namespace {

template <int P>
const ContactBlock<P>& empty_block() {
  static const ContactBlock<P> kEmpty = [] {
    ContactBlock<P> empty;
    std::memset(static_cast<void*>(&empty), 0, sizeof empty);
    for (std::uint32_t& c : empty.contact.lane) c = kNoContact;
    for (Field& base : empty.base) {
      for (float& s : base.lane) s = kFarSeparated;
    }
    return empty;
  }();
  return kEmpty;
}

template <int P>
void clear_slot(ContactBlock<P>& block, int lane) {
  copy_slot(empty_block<P>(), 0, block, lane);
}

}  // namespace

// A body that no impulse moves may still move, with the others of its region. So its region counts,
// unless it is the world itself.
std::uint16_t region_of(const ContactGraph::End& a, const ContactGraph::End& b) {
  if (a.state == kWorldState) return b.region;
  return b.state == kWorldState || a.region == b.region ? a.region : kSharedRegion;
}

// With several regions, the contacts between regions belong to bodies on their faces: about 2 n^2
// for a region of n^3 bodies, since two regions share each face.
void ContactGraph::reserve(std::size_t bodies) {
  if (bodies == reserved_bodies_ && regions() == reserved_regions_) return;
  reserved_bodies_ = bodies;
  reserved_regions_ = regions();
  constexpr int kReady = 8, kReadyFixed = 4;  // colours
  const std::size_t within = regions() - 1;
  const auto all = static_cast<double>(bodies);
  const double faces =
      within == 0 ? 0.0 : std::min(1.0, 2.0 / std::cbrt(all / static_cast<double>(within)));
  for (std::size_t region = 0; region < regions(); ++region) {
    const std::size_t fraction = within == 0               ? bodies
                                 : region == kSharedRegion ? static_cast<std::size_t>(faces * all)
                                                           : bodies / within + 1;
    if (within > 0 && fraction < 2 * kLanes) continue;  // a block per colour would be too much
    const std::size_t blocks = fraction / (2 * kLanes) + 1;
    for (int c = 0; c < kFirstFixedColour + kReadyFixed; ++c) {
      if (c >= kReady && c < kFirstFixedColour) continue;
      of<1>(region, c).blocks.reserve(blocks);
      of<4>(region, c).blocks.reserve(blocks);
    }
  }
}

void ContactGraph::clear() {
  const auto empty = [](auto& colours) {
    for (auto& colour : colours) {
      colour.blocks.clear();
      colour.slots = 0;
    }
  };
  for (std::size_t region = 0; region < regions_in_use_; ++region) {
    empty(regions_[region].ones);
    empty(regions_[region].fours);
    regions_[region].in_use = {};
  }
  regions_in_use_ = 1;
  std::fill(taken_.begin(), taken_.end(), ColourSet{});
}

int ContactGraph::free_colour(const End& a, const End& b) const {
  ColourSet taken;
  if (a.moves) taken.insert(taken_[a.state]);
  if (b.moves) taken.insert(taken_[b.state]);
  return taken.lowest_free(!a.moves || !b.moves);
}

ContactSlot ContactGraph::add(std::uint32_t contact, const End& a, const End& b, int points) {
  ContactSlot slot;
  (void)append(contact, a, b, points, free_colour(a, b), slot);
  return slot;
}

bool ContactGraph::append(std::uint32_t contact, const End& a, const End& b, int points, int colour,
                          ContactSlot& slot) {
  if ((!a.moves || !b.moves) && colour < kFirstFixedColour) return false;
  if (colour < kLastColour) {
    if ((a.moves && taken_[a.state].has(colour)) || (b.moves && taken_[b.state].has(colour))) {
      return false;
    }
    if (a.moves) taken_[a.state].insert(colour);
    if (b.moves) taken_[b.state].insert(colour);
  }
  slot.points = static_cast<std::uint8_t>(points);
  slot.colour = static_cast<std::uint8_t>(colour);
  slot.region = colour == kParked ? kSharedRegion : region_of(a, b);
  points == 1 ? add_slot<1>(contact, a, b, slot) : add_slot<4>(contact, a, b, slot);
  return true;
}

std::uint32_t ContactGraph::remove(const ContactSlot& slot, const End& a, const End& b) {
  if (slot.colour < kLastColour) {
    if (a.moves) taken_[a.state].erase(slot.colour);
    if (b.moves) taken_[b.state].erase(slot.colour);
  }
  return slot.points == 1 ? remove_slot<1>(slot) : remove_slot<4>(slot);
}

// Capacity that one region needs, the others will need too: reserves it in all regions at once. Not
// for the last colour: a body with hundreds of contacts fills it in its own region, with a block
// per contact.
template <int P>
void ContactGraph::ensure_capacity(const ContactSlot& slot) {
  const std::size_t capacity = 2 * of<P>(slot.region, slot.colour).blocks.capacity() + 1;
  const bool of_all = slot.region != kSharedRegion && slot.colour != kLastColour;
  for (std::size_t region = 1; of_all && region < regions(); ++region) {
    of<P>(region, slot.colour).blocks.reserve(capacity);
  }
  of<P>(slot.region, slot.colour).blocks.reserve(capacity);
}

template <int P>
void ContactGraph::add_slot(std::uint32_t contact, const End& a, const End& b, ContactSlot& slot) {
  ColourBlocks<P>& colour = of<P>(slot.region, slot.colour);
  if (slot.colour < kColours) regions_[slot.region].in_use.insert(slot.colour);
  slot.index = colour.slots++;
  const std::size_t block = ColourBlocks<P>::block_of(slot.index, slot.colour);
  const int lane = ColourBlocks<P>::lane_of(slot.index, slot.colour);
  if (block == colour.blocks.size()) {
    if (block == colour.blocks.capacity()) ensure_capacity<P>(slot);
    colour.blocks.push_back(empty_block<P>());
  } else {
    clear_slot(colour.blocks[block], lane);  // passes also write into empty slots
  }
  ContactBlock<P>& to = colour.blocks[block];
  to.a.lane[lane] = a.state;
  to.b.lane[lane] = b.state;
  to.contact.lane[lane] = contact;
}

template <int P>
std::uint32_t ContactGraph::remove_slot(const ContactSlot& slot) {
  ColourBlocks<P>& colour = of<P>(slot.region, slot.colour);
  ContactSlot last = slot;
  last.index = --colour.slots;
  ContactBlock<P>& from = block<P>(last);
  std::uint32_t moved = kNoContact;
  if (last.index != slot.index) {
    copy_slot(from, lane(last), block<P>(slot), lane(slot));
    moved = block<P>(slot).contact.lane[lane(slot)];
  }
  clear_slot(from, lane(last));
  if (slot.colour == kLastColour || last.index % kLanes == 0) colour.blocks.pop_back();
  Region& region = regions_[slot.region];
  if (slot.colour < kColours &&
      region.ones[slot.colour].slots + region.fours[slot.colour].slots == 0) {
    region.in_use.erase(slot.colour);
  }
  return moved;
}

template <int P>
std::uint32_t ContactGraph::move_slot(ContactSlot& slot, const End& a, const End& b, int colour) {
  const ContactSlot from = slot;
  (void)append(block<P>(from).contact.lane[lane(from)], a, b, P, colour, slot);
  copy_slot(block<P>(from), lane(from), block<P>(slot), lane(slot));
  return remove(from, a, b);
}

std::uint32_t ContactGraph::follow(ContactSlot& slot, const End& a, const End& b) {
  const ContactSlot from = slot;
  slot.region = region_of(a, b);
  if (slot.region == from.region) return kNoContact;
  const auto move = [&]<int P>() {
    add_slot<P>(block<P>(from).contact.lane[lane(from)], a, b, slot);
    copy_slot(block<P>(from), lane(from), block<P>(slot), lane(slot));
    return remove_slot<P>(from);
  };
  return from.points == 1 ? move.template operator()<1>() : move.template operator()<4>();
}

template std::uint32_t ContactGraph::move_slot<1>(ContactSlot&, const End&, const End&, int);
template std::uint32_t ContactGraph::move_slot<4>(ContactSlot&, const End&, const End&, int);

}  // namespace vp::solve
