// Digests of a world's topology and state.
#pragma once

#include <cstdint>

namespace vp {

// Mixes a 64-bit value into a digest.
inline std::uint64_t mixed(std::uint64_t digest, std::uint64_t value) {
  digest = (digest ^ value) * 0x9e3779b97f4a7c15u;
  return digest ^ (digest >> 29);
}

}  // namespace vp
