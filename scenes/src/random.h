// Fixed-seed random numbers for the scenes: splitmix64, the same on every machine. Source: Steele,
// Lea, Flood, Fast splittable pseudorandom number generators, 2014.
#pragma once

#include <cstdint>

#include "vphysics/lie.h"

namespace scenes {

class Random {
 public:
  explicit Random(std::uint64_t seed) : state_(seed) {}

  double uniform(double lower, double upper) {
    return lower + (upper - lower) * static_cast<double>(word() >> 11) * 0x1p-53;
  }
  vp::Vec3 in_cube(double half) {
    const double x = uniform(-half, half), y = uniform(-half, half), z = uniform(-half, half);
    return {x, y, z};
  }

 private:
  std::uint64_t word() {
    std::uint64_t z = (state_ += 0x9e3779b97f4a7c15u);
    z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
    z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
    return z ^ (z >> 31);
  }
  std::uint64_t state_;
};

}  // namespace scenes
