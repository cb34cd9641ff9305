// What a call about a pair of shapes leaves for the next call about the same pair.
#pragma once

#include <cstdint>
#include <type_traits>

namespace vp::collide {

// Zero at first. Plain data, kept by the caller for each pair in the order (a, b), part of a
// snapshot. Any bytes are safe: what makes no sense for the pair is not used, and of two caches the
// better one only saves time, GJK's last bits aside.
struct PairCache {
  enum Feature : std::uint8_t {
    none,
    face_of_a,  // i
    face_of_b,  // i
    edges,      // edge i of a, edge j of b; of two boxes their axes
  };
  float normal[3] = {};  // in a's frame, from a to b: along it they were apart, or overlapped least
  std::uint16_t i = 0, j = 0;  // what that is the normal of
  std::uint8_t feature = none;
  std::uint8_t unused[3] = {};
};
static_assert(sizeof(PairCache) == 20 && std::is_trivially_copyable_v<PairCache>);

}  // namespace vp::collide
