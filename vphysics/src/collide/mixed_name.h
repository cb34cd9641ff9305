// Hashed feature names within a pair, from several numbers.
#pragma once

#include <cstdint>

namespace vp::collide {

// Different numbers collide with a probability of one in 2^32. The same on every machine.
inline std::uint32_t mixed_name(std::uint32_t a, std::uint32_t b, std::uint32_t c) {
  std::uint64_t x = ((std::uint64_t{a} << 32) | b) * 0x9e3779b97f4a7c15u + c;
  x = (x ^ (x >> 32)) * 0xd6e8feb86659fd93u;
  return static_cast<std::uint32_t>(x >> 32);
}

}  // namespace vp::collide
