// Speculative pairs: close pairs without contact points, in blocks of sixteen. Each has a
// clearance, the relative displacement after which the narrow phase must process the pair again.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "solve/contact_block.h"

namespace vphysics_solver {

struct SpeculativeBlock {
  IndexField a, b;     // rows of the bodies; the world's row in an empty slot
  IndexField contact;  // kNoContact in an empty slot
  // State at the last narrow phase: the rows' displacements and rotations [m], [rad].
  Field3 x_a, turn_a, x_b, turn_b;
  // Arms from the bodies' centres to the centre of a ball in which the two meet, and its radius,
  // the lever arm of relative rotation [m]. The clearance is the permitted relative displacement
  // [m].
  Field3 arm_a, arm_b;
  Field radius;
  Field clearance;
};
inline constexpr std::size_t kSpeculativeFields =
    (sizeof(SpeculativeBlock) - 3 * sizeof(IndexField)) / sizeof(Field);
static_assert(sizeof(SpeculativeBlock) % sizeof(Field) == 0);

}  // namespace vphysics_solver

namespace vp::solve {

inline std::span<Field, kSpeculativeFields> fields_of(SpeculativeBlock& block) {
  return std::span<Field, kSpeculativeFields>(reinterpret_cast<Field*>(&block.x_a),
                                              kSpeculativeFields);
}
inline std::span<const Field, kSpeculativeFields> fields_of(const SpeculativeBlock& block) {
  return std::span<const Field, kSpeculativeFields>(reinterpret_cast<const Field*>(&block.x_a),
                                                    kSpeculativeFields);
}

// The last slot fills a slot that becomes empty.
class SpeculativeList {
 public:
  // Returns the index of the new slot. All its other fields are zero.
  std::uint32_t add(std::uint32_t contact, std::uint32_t row_a, std::uint32_t row_b);
  // The same for a copy of a slot of another list.
  std::uint32_t add(const SpeculativeList& from, std::uint32_t index);
  // Returns the contact whose slot has moved to this index, or kNoContact.
  std::uint32_t remove(std::uint32_t index);

  // Keeps its memory.
  void clear() {
    blocks_.clear();
    lanes_ = 0;
  }

  std::uint32_t size() const { return lanes_; }
  std::span<SpeculativeBlock> blocks() { return blocks_; }
  SpeculativeBlock& block(std::uint32_t index) { return blocks_[index / kLanes]; }
  const SpeculativeBlock& block(std::uint32_t index) const { return blocks_[index / kLanes]; }
  static int lane(std::uint32_t index) { return static_cast<int>(index % kLanes); }
  void reserve(std::size_t contacts) { blocks_.reserve(contacts / kLanes + 1); }

 private:
  std::vector<SpeculativeBlock> blocks_;
  std::uint32_t lanes_ = 0;
};

}  // namespace vp::solve
