// Where contacts live: in blocks of lanes, sorted by colour.
//
// No two contacts of a colour share a body that moves, so that a colour's contacts can be solved
// side by side, in lanes and by several workers, with the same result in any order. A contact takes
// the lowest colour that both its bodies have free, and keeps it while it lasts; a lane that
// becomes empty is filled with the colour's last. So the order of solving follows from the order of
// the calls alone. Contacts with what nothing pushes have colours of their own, solved last.
//
// A body with more contacts than there are colours puts the rest into the last one, where every
// contact has a block to itself: blocks are solved one after the other.
//
// A large world is divided into regions (world/regions.cpp): a contact of two bodies of one region,
// or of one and the fixed world, is kept there, colour by colour, all others in kBetween. So no two
// regions share a body, and each can be solved by itself, again and again, while it lies in the
// caches.
// Colours are those of the whole world: a contact that goes to another region keeps its own.
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
inline constexpr int kFirstFixedColour = 64;  // of contacts with what nothing pushes
inline constexpr int kLastColour = kColours - 1;
inline constexpr int kParked = kColours;  // no colour: lanes put aside, of what is asleep

// Some of the colours: a bit for each of those between bodies that move, then of the others.
class ColourSet {
 public:
  bool has(int colour) const { return (bits_[colour / 64] >> (colour % 64) & 1u) != 0; }
  void insert(int colour) { bits_[colour / 64] |= 1ull << (colour % 64); }
  void erase(int colour) { bits_[colour / 64] &= ~(1ull << (colour % 64)); }
  void insert(const ColourSet& other) {
    for (int half = 0; half < 2; ++half) bits_[half] |= other.bits_[half];
  }
  // Ascending.
  template <class F>
  void for_each(const F& f) const {
    for (int half = 0; half < 2; ++half) {
      for (std::uint64_t left = bits_[half]; left != 0; left &= left - 1)
        f(64 * half + std::countr_zero(left));
    }
  }
  int size() const { return std::popcount(bits_[0]) + std::popcount(bits_[1]); }
  // The lowest that is not in it, of those of contacts with what nothing pushes or of the others;
  // the last colour if all are.
  int lowest_free(bool fixed) const {
    const int free = std::countr_one(bits_[fixed ? 1 : 0]);
    return std::min(fixed ? kFirstFixedColour + free : free < 64 ? free : kLastColour, kLastColour);
  }

 private:
  std::uint64_t bits_[2] = {0, 0};
};
static_assert(kColours == 128 && kFirstFixedColour == 64);

// Of contacts of several regions, of bodies that are in none, and of all that is put aside.
inline constexpr std::uint16_t kBetween = 0;

// Where a contact's lane is; points: 1 or 4, or 0 for nowhere.
struct ContactSlot {
  std::uint8_t points = 0, colour = 0;
  std::uint16_t region = kBetween;
  std::uint32_t index = 0;  // of the lane, among all of its region, colour and kind
};

template <int P>
struct ColourBlocks {
  std::vector<ContactBlock<P>> blocks;
  std::uint32_t lanes = 0;  // used; in the last colour one a block

  static constexpr std::uint32_t block_of(std::uint32_t index, int colour) {
    return colour == kLastColour ? index : index / kLanes;
  }
  static constexpr int lane_of(std::uint32_t index, int colour) {
    return colour == kLastColour ? 0 : static_cast<int>(index % kLanes);
  }
};

// All of a block that is not an index.
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
  // moves: an impulse can move it.
  struct End {
    std::uint32_t row;
    bool moves;
    std::uint16_t region;
  };
  // An empty lane for the contact; all its fields are zero but the rows and the contact.
  ContactSlot add(std::uint32_t contact, const End& a, const End& b, int points);
  // The same at the end of a given colour, as when a state is restored; false if that is not open
  // to it.
  bool append(std::uint32_t contact, const End& a, const End& b, int points, int colour,
              ContactSlot& slot);
  // Returns the contact whose lane was moved to fill the gap, or kNoContact: its place is now this
  // one's.
  std::uint32_t remove(const ContactSlot& slot, const End& a, const End& b);
  // Puts a lane aside as it is, or back into a colour; place becomes its new one. Returns as
  // remove() does, of the old place.
  std::uint32_t park(ContactSlot& slot, const End& a, const End& b) {
    return slot.points == 1 ? move_slot<1>(slot, a, b, kParked) : move_slot<4>(slot, a, b, kParked);
  }
  std::uint32_t unpark(ContactSlot& slot, const End& a, const End& b) {
    const int colour = free_colour(a, b);
    return slot.points == 1 ? move_slot<1>(slot, a, b, colour) : move_slot<4>(slot, a, b, colour);
  }

  // To the region that its ends are in now, in its colour. Precondition: it is not put aside.
  // Returns as remove() does, of the old place.
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
  // Of which the region has lanes of either kind.
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
  // kBetween and those behind it. Precondition of set_regions: those that go are empty. Their
  // memory stays, for when they are back.
  std::size_t regions() const { return regions_in_use_; }
  void set_regions(std::size_t count) {
    if (count > regions_.size()) regions_.resize(count);
    regions_in_use_ = count;
  }
  // No lanes and no regions but kBetween; memory stays.
  void clear();
  // Room for rows; and for the first contacts of so many bodies, so that a busy step need not take
  // it from the heap.
  void resize(std::size_t rows) { taken_.resize(rows); }
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
  std::size_t reserved_bodies_ = 0, reserved_regions_ = 0;  // by reserve()
  std::vector<ColourSet> taken_;                            // by a row's contacts
};

}  // namespace vp::solve
