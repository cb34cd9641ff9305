// Pairs that are near one another and have no points, sixteen side by side: how far each may still
// go before the narrow phase must look at it again.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "solve/contact_block.h"

namespace vphysics_solver {

struct SpeculativeBlock {
  IndexField a, b;     // rows of the bodies; of an empty lane the world's
  IndexField contact;  // kNoContact: an empty lane
  // When it was last looked at: the rows' ways, and how far the two may go against each other [m].
  Field3 x_a, turn_a, x_b, turn_b;
  // From the bodies' centres to that of a ball in which the two meet, and its radius as far as
  // rotation counts [m].
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

// A lane that becomes empty is filled with the last.
class SpeculativeList {
 public:
  // The index of its lane; all of that is zero but what is given.
  std::uint32_t add(std::uint32_t contact, std::uint32_t row_a, std::uint32_t row_b);
  // The same, of a lane of another list, as it is.
  std::uint32_t add(const SpeculativeList& from, std::uint32_t index);
  // Returns the contact whose lane has now this index, or kNoContact.
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
