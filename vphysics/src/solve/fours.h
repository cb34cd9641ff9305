// Sums of doubles in groups of four. The order of summation, and so every bit, is the same on every
// machine.
#pragma once

#include <cstddef>
#include <cstring>

namespace vp::solve {

inline constexpr std::size_t kFour = 4;
inline std::size_t in_fours(std::size_t n) {
  return (n + kFour - 1) / kFour * kFour;
}
using Four = double __attribute__((vector_size(kFour * sizeof(double))));
// n: a multiple of four.
inline void add_scaled(double* to, const double* a, double factor, std::size_t n) {
  const Four factors = {factor, factor, factor, factor};
  Four x, y;
  for (std::size_t k = 0; k < n; k += kFour) {
    std::memcpy(&x, a + k, sizeof x);
    std::memcpy(&y, to + k, sizeof y);
    y += factors * x;
    std::memcpy(to + k, &y, sizeof y);
  }
}

}  // namespace vp::solve
