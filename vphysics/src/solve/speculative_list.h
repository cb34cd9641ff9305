// Speculative pairs: close pairs without contact points, in blocks of sixteen. Each has a
// clearance, the approach after which the narrow phase must process the pair again.
#pragma once

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <span>
#include <vector>

#include "solve/contact_block.h"
#include "solve/large_pages.h"

namespace vphysics_solver {

// Read as three rows of eight floats. 96 bytes.
struct alignas(32) SpeculativePair {
  // State at the last narrow phase: the displacement of b less that of a, and the rotations [m],
  // [rad].
  float x[3], rotation_a[3], rotation_b[3];
  // Arms from the bodies' centres to the centre of the sphere in which the two can touch [m].
  float arm_a[3], arm_b[3];
  // A direction from a to b that separated them, or zero.
  float normal[3];
  float radius;  // of that sphere: the lever arm of relative rotation [m]
  // How far they may approach each other along the normal; without one, the permitted relative
  // displacement [m].
  float clearance;
  float turns_with;       // the body with which the normal rotates: 1: a, 0: b, -1: none
  std::uint32_t a, b;     // indices of the bodies' states; kWorldState in an empty slot
  std::uint32_t contact;  // kNoContact in an empty slot
};
inline constexpr std::size_t kSpeculativeFloats = 21;
static_assert(sizeof(SpeculativePair) == 96 &&
              offsetof(SpeculativePair, a) == kSpeculativeFloats * sizeof(float));
inline bool is_between_spheres(const SpeculativePair& pair) {
  return pair.turns_with < 0.0f;
}
struct SpeculativeBlock {
  SpeculativePair pairs[kLanes];
};

}  // namespace vphysics_solver

namespace vp::solve {

// The number f < kSpeculativeFloats, in the order above.
inline float near_float(const SpeculativePair& pair, std::size_t f) {
  float x;
  std::memcpy(&x, reinterpret_cast<const std::byte*>(&pair) + f * sizeof x, sizeof x);
  return x;
}
inline void set_near_float(SpeculativePair& pair, std::size_t f, float x) {
  std::memcpy(reinterpret_cast<std::byte*>(&pair) + f * sizeof x, &x, sizeof x);
}

// The last slot fills a slot that becomes empty.
class SpeculativeList {
 public:
  // Returns the index of the new slot. All its other fields are zero.
  std::uint32_t add(std::uint32_t contact, std::uint32_t state_a, std::uint32_t state_b);
  // The same for a copy of a slot of another list.
  std::uint32_t add(const SpeculativeList& from, std::uint32_t index);
  // Returns the contact whose slot has moved to this index, or kNoContact.
  std::uint32_t remove(std::uint32_t index);

  // Keeps its memory.
  void clear() {
    blocks_.clear();
    size_ = 0;
  }

  std::uint32_t size() const { return size_; }
  std::span<SpeculativeBlock> blocks() { return blocks_; }
  SpeculativePair& pair(std::uint32_t index) {
    return blocks_[index / kLanes].pairs[index % kLanes];
  }
  const SpeculativePair& pair(std::uint32_t index) const {
    return blocks_[index / kLanes].pairs[index % kLanes];
  }
  void reserve(std::size_t contacts) { blocks_.reserve(contacts / kLanes + 1); }

 private:
  LargeVector<SpeculativeBlock> blocks_;
  std::uint32_t size_ = 0;
};

}  // namespace vp::solve
