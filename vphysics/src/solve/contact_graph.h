// Stores contacts in blocks of slots, sorted by graph colour.
//
// No two contacts of a colour share a movable body. So the contacts of a colour can be solved in
// parallel, in SIMD lanes and by several workers, with the same result in any order. A contact
// takes the lowest colour that is free at both its bodies, and keeps it while it exists. The last
// slot of a colour fills a slot that becomes empty. So the order of the calls alone determines the
// order of solving. Contacts with static bodies have colours of their own, which are solved last.
//
// A body with more contacts than there are colours puts the rest into the last colour. There every
// contact has a block to itself, and blocks are solved one after another.
//
// A large world is divided into regions (world/regions.cpp). A contact between two bodies of one
// region, or between one of them and the fixed world, is stored in that region, colour by colour.
// All others are stored in kSharedRegion. So no two regions share a body, and each can be solved on
// its own, for several iterations, while its data is in cache. Colours are global: a contact that
// moves to another region keeps its colour.
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>
#include <span>
#include <vector>

#include "solve/contact_block.h"

namespace vp::solve {

inline constexpr int kColours = 128;
inline constexpr int kFirstFixedColour = 64;  // for contacts with static bodies
inline constexpr int kLastColour = kColours - 1;
inline constexpr int kParked = kColours;  // no colour: the slots of sleeping contacts

// A set of colours: a bit for each colour between movable bodies, then for each of the others.
class ColourSet {
 public:
  bool has(int colour) const { return (bits_[colour / 64] >> (colour % 64) & 1u) != 0; }
  void insert(int colour) { bits_[colour / 64] |= 1ull << (colour % 64); }
  void erase(int colour) { bits_[colour / 64] &= ~(1ull << (colour % 64)); }
  void insert(const ColourSet& other) {
    for (int half = 0; half < 2; ++half) bits_[half] |= other.bits_[half];
  }
  // Calls f(colour) in ascending order.
  template <class F>
  void for_each(const F& f) const {
    for (int half = 0; half < 2; ++half) {
      for (std::uint64_t left = bits_[half]; left != 0; left &= left - 1)
        f(64 * half + std::countr_zero(left));
    }
  }
  int size() const { return std::popcount(bits_[0]) + std::popcount(bits_[1]); }
  // The lowest colour that is not in the set, among those for contacts with static bodies (fixed)
  // or among the others; the last colour if all are taken.
  int lowest_free(bool fixed) const {
    const int free = std::countr_one(bits_[fixed ? 1 : 0]);
    return std::min(fixed ? kFirstFixedColour + free : free < 64 ? free : kLastColour, kLastColour);
  }

 private:
  std::uint64_t bits_[2] = {0, 0};
};
static_assert(kColours == 128 && kFirstFixedColour == 64);

// The region of contacts between regions, of contacts of bodies in no region, and of all parked
// slots.
inline constexpr std::uint16_t kSharedRegion = 0;

// The location of a contact's slot. points: 1 or 4, or 0 if it has none.
struct ContactSlot {
  std::uint8_t points = 0, colour = 0;
  std::uint16_t region = kSharedRegion;
  std::uint32_t index = 0;  // of the slot, among those of its region, colour and point count
};

template <int P>
struct ColourBlocks {
  std::vector<ContactBlock<P>> blocks;
  std::uint32_t slots = 0;  // in use; in the last colour one per block

  static constexpr std::uint32_t block_of(std::uint32_t index, int colour) {
    return colour == kLastColour ? index : index / kLanes;
  }
  static constexpr int lane_of(std::uint32_t index, int colour) {
    return colour == kLastColour ? 0 : static_cast<int>(index % kLanes);
  }
};

// All float fields of a block that persist across steps.
template <int P>
std::span<Field> fields_of(ContactBlock<P>& block) {
  return {reinterpret_cast<Field*>(&block.normal), kFieldsOf<P>};
}
template <int P>
std::span<const Field> fields_of(const ContactBlock<P>& block) {
  return {reinterpret_cast<const Field*>(&block.normal), kFieldsOf<P>};
}

class ContactGraph {
 public:
  // moves: whether an impulse can move the body.
  struct End {
    std::uint32_t state;
    bool moves;
    std::uint16_t region;
  };
  // Allocates a slot for the contact. All its fields are zero except the indices of the states and
  // of the contact.
  ContactSlot add(std::uint32_t contact, const End& a, const End& b, int points);
  // Allocates a slot at the end of a given colour, as for restoring a state. Returns false if the
  // contact may not use that colour.
  bool append(std::uint32_t contact, const End& a, const End& b, int points, int colour,
              ContactSlot& slot);
  // Returns the contact that was moved into the freed slot, or kNoContact.
  std::uint32_t remove(const ContactSlot& slot, const End& a, const End& b);
  // Moves a slot unchanged into the parked slots, or back into a colour, and updates `slot`.
  // Returns as remove() does, for the old slot.
  std::uint32_t park(ContactSlot& slot, const End& a, const End& b) {
    return slot.points == 1 ? move_slot<1>(slot, a, b, kParked) : move_slot<4>(slot, a, b, kParked);
  }
  std::uint32_t unpark(ContactSlot& slot, const End& a, const End& b) {
    const int colour = free_colour(a, b);
    return slot.points == 1 ? move_slot<1>(slot, a, b, colour) : move_slot<4>(slot, a, b, colour);
  }

  // Moves a slot to the region that its ends are in now; the colour stays. Precondition: the slot
  // is not parked. Returns as remove() does, for the old slot.
  std::uint32_t follow(ContactSlot& slot, const End& a, const End& b);

  template <int P>
  ContactBlock<P>& block(const ContactSlot& slot) {
    return of<P>(slot.region, slot.colour)
        .blocks[ColourBlocks<P>::block_of(slot.index, slot.colour)];
  }
  template <int P>
  const ContactBlock<P>& block(const ContactSlot& slot) const {
    return const_cast<ContactGraph*>(this)->block<P>(slot);
  }
  static int lane(const ContactSlot& slot) {
    return ColourBlocks<1>::lane_of(slot.index, slot.colour);
  }
  // The colours in which the region has slots of either kind.
  const ColourSet& colours_in_use(std::size_t region) const { return regions_[region].in_use; }
  template <int P>
  ColourBlocks<P>& of(std::size_t region, int colour) {
    if constexpr (P == 1)
      return regions_[region].ones[static_cast<std::size_t>(colour)];
    else
      return regions_[region].fours[static_cast<std::size_t>(colour)];
  }
  template <int P>
  const ColourBlocks<P>& of(std::size_t region, int colour) const {
    return const_cast<ContactGraph*>(this)->of<P>(region, colour);
  }
  // The number of regions: kSharedRegion and those after it. Precondition of set_regions: the
  // regions that are removed are empty. Their memory is kept for later use.
  std::size_t regions() const { return regions_in_use_; }
  void set_regions(std::size_t count) {
    if (count > regions_.size()) regions_.resize(count);
    regions_in_use_ = count;
  }
  // Removes all slots and all regions except kSharedRegion; keeps the memory.
  void clear();
  // resize: capacity for the states. reserve: capacity for the first contacts of this many bodies,
  // so that a busy step need not allocate.
  void resize(std::size_t states) { taken_.resize(states); }
  void reserve(std::size_t bodies);

 private:
  template <int P>
  void ensure_capacity(const ContactSlot& slot);
  template <int P>
  void add_slot(std::uint32_t contact, const End& a, const End& b, ContactSlot& slot);
  template <int P>
  std::uint32_t remove_slot(const ContactSlot& slot);
  template <int P>
  std::uint32_t move_slot(ContactSlot& slot, const End& a, const End& b, int colour);
  int free_colour(const End& a, const End& b) const;

  struct Region {
    std::array<ColourBlocks<1>, kColours + 1> ones;
    std::array<ColourBlocks<4>, kColours + 1> fours;
    ColourSet in_use;
  };
  std::vector<Region> regions_{1};
  std::size_t regions_in_use_ = 1;
  std::size_t reserved_bodies_ = 0, reserved_regions_ = 0;  // set by reserve()
  std::vector<ColourSet> taken_;  // of each state: the colours of its contacts
};

// The region of a contact or joint of two bodies.
std::uint16_t region_of(const ContactGraph::End& a, const ContactGraph::End& b);

}  // namespace vp::solve
