// Data that a query for a pair of shapes caches for the next query for the same pair.
#pragma once

#include <cstdint>
#include <type_traits>

namespace vp::collide {

// Initially zero. Plain data, stored by the caller for each pair in the order (a, b); part of a
// snapshot. Any bytes are safe: values that are invalid for the pair are ignored. A better cache
// only saves time, except for the last bits of GJK's results.
struct PairCache {
  enum Feature : std::uint8_t {
    none,
    face_of_a,  // i
    face_of_b,  // i
    edges,      // edge i of a, edge j of b; for two boxes their axes
  };
  float normal[3] = {};  // in a's frame, from a to b: the axis of separation or minimum overlap
  std::uint16_t i = 0, j = 0;  // the features that define the normal
  std::uint8_t feature = none;
  std::uint8_t unused[3] = {};
};
static_assert(sizeof(PairCache) == 20 && std::is_trivially_copyable_v<PairCache>);

}  // namespace vp::collide
