// Names of features within a pair, made of several numbers.
#pragma once

#include <cstdint>

namespace vp::collide {

// Different for different numbers but by chance, one in 2^32; the same on every machine.
inline std::uint32_t mixed_name(std::uint32_t a, std::uint32_t b, std::uint32_t c) {
  std::uint64_t x = ((std::uint64_t{a} << 32) | b) * 0x9e3779b97f4a7c15u + c;
  x = (x ^ (x >> 32)) * 0xd6e8feb86659fd93u;
  return static_cast<std::uint32_t>(x >> 32);
}

}  // namespace vp::collide
