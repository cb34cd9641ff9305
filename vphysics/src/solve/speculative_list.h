// Pairs that are near one another and have no points: how far each may still go before the narrow
// phase must look at it again.
//
// They come and go, and are set one by one, far more often than all are gone through: each has its
// numbers side by side, in two cache lines, and the pass over all of them transposes.
#pragma once

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <span>
#include <vector>

#include "solve/contact_block.h"

namespace vphysics_solver {

// Read as three rows of eight floats. 96 bytes.
struct alignas(32) NearPair {
  // When it was last looked at: the rows' ways, and how far the two may go against each other [m].
  float x_a[3], turn_a[3], x_b[3], turn_b[3];
  // From the bodies' centres to that of a ball in which the two meet, and its radius as far as
  // rotation counts [m].
  float arm_a[3], arm_b[3];
  float radius;
  float clearance;
  std::uint32_t a, b;     // rows of the bodies; of an empty one the world's
  std::uint32_t contact;  // kNoContact: an empty one
  std::uint32_t unused;
};
inline constexpr std::size_t kNearFloats = 20;
static_assert(sizeof(NearPair) == 96 && offsetof(NearPair, a) == kNearFloats * sizeof(float));
struct SpeculativeBlock {
  NearPair pairs[kLanes];
};

}  // namespace vphysics_solver

namespace vp::solve {

// The number f < kNearFloats, in the order above.
inline float near_float(const NearPair& pair, std::size_t f) {
  float x;
  std::memcpy(&x, reinterpret_cast<const std::byte*>(&pair) + f * sizeof x, sizeof x);
  return x;
}
inline void set_near_float(NearPair& pair, std::size_t f, float x) {
  std::memcpy(reinterpret_cast<std::byte*>(&pair) + f * sizeof x, &x, sizeof x);
}

// A pair that is removed leaves its place to the last.
class SpeculativeList {
 public:
  // Its index; all of it is zero but what is given.
  std::uint32_t add(std::uint32_t contact, std::uint32_t row_a, std::uint32_t row_b);
  // The same, of a pair of another list, as it is.
  std::uint32_t add(const SpeculativeList& from, std::uint32_t index);
  // Returns the contact whose pair has now this index, or kNoContact.
  std::uint32_t remove(std::uint32_t index);

  // Keeps its memory.
  void clear() {
    blocks_.clear();
    size_ = 0;
  }

  std::uint32_t size() const { return size_; }
  std::span<SpeculativeBlock> blocks() { return blocks_; }
  NearPair& pair(std::uint32_t index) { return blocks_[index / kLanes].pairs[index % kLanes]; }
  const NearPair& pair(std::uint32_t index) const {
    return blocks_[index / kLanes].pairs[index % kLanes];
  }
  void reserve(std::size_t contacts) { blocks_.reserve(contacts / kLanes + 1); }

 private:
  std::vector<SpeculativeBlock> blocks_;
  std::uint32_t size_ = 0;
};

}  // namespace vp::solve
