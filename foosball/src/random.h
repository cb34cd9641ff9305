// A small random generator with the same output on every platform (the standard's distributions
// differ). PCG-XSH-RR 64/32, O'Neill 2014. SplitMix64 seeds it, so that neighbouring seeds give
// different sequences.
#pragma once

#include <cstdint>

namespace foosball {

class Random {
 public:
  explicit Random(std::uint64_t seed) : state_(mix(seed)) {}

  std::uint32_t next() {
    const std::uint64_t old = state_;
    state_ = old * 6364136223846793005u + 1442695040888963407u;
    const auto xorshifted = static_cast<std::uint32_t>(((old >> 18u) ^ old) >> 27u);
    const auto rotation = static_cast<std::uint32_t>(old >> 59u);
    return (xorshifted >> rotation) | (xorshifted << ((32u - rotation) & 31u));
  }
  double unit() { return next() * 0x1p-32; }  // [0, 1)
  double between(double low, double high) { return low + (high - low) * unit(); }
  int below(int n) {
    return static_cast<int>((std::uint64_t{next()} * static_cast<std::uint32_t>(n)) >> 32);
  }
  // Approximately normal: mean 0, standard deviation 1, within +-3. The sum of three uniforms.
  double bell() { return 2.0 * (unit() + unit() + unit() - 1.5); }

  std::uint64_t state() const { return state_; }
  void set_state(std::uint64_t state) { state_ = state; }

 private:
  static std::uint64_t mix(std::uint64_t x) {
    x += 0x9e3779b97f4a7c15u;
    x = (x ^ (x >> 30)) * 0xbf58476d1ce4e5b9u;
    x = (x ^ (x >> 27)) * 0x94d049bb133111ebu;
    return x ^ (x >> 31);
  }
  std::uint64_t state_;
};

}  // namespace foosball
