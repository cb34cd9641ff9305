// Finds overlapping bounds by sort and sweep along the axis with the largest variance of the
// centres.
//
// The pairs and their order depend on the bounds alone. The order kept between calls only makes the
// next sort cheap.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "collide/bounds.h"

namespace vp::collide {

struct IndexPair {
  std::uint32_t a, b;  // a < b
  // The linter mistakes the 0 that the compiler compares with for a pointer.
  constexpr auto operator<=>(const IndexPair&) const = default;  // NOLINT(modernize-use-nullptr)
};

class BroadPhase {
 public:
  // Appends, sorted, every pair of overlapping, non-empty bounds of which at least one is movable.
  void find_pairs(std::span<const Bounds> bounds, std::span<const std::uint8_t> movable,
                  std::vector<IndexPair>& pairs);

 private:
  int widest_axis(std::span<const Bounds> bounds) const;
  void sort_along(int axis, std::span<const Bounds> bounds);

  static constexpr std::uint32_t kCallsPerAxis = 64;
  std::vector<std::uint32_t> order_;
  std::uint32_t calls_ = 0;
  int axis_ = 0;
};

}  // namespace vp::collide
