// Fixed-seed random numbers for the tests: splitmix64, the same on every machine.
#pragma once

#include <cstdint>

#include "vphysics/lie.h"

namespace vp::test {

class Random {
 public:
  explicit Random(std::uint64_t seed) : state_(seed) {}

  std::uint64_t word() {
    std::uint64_t z = (state_ += 0x9e3779b97f4a7c15u);
    z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
    z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
    return z ^ (z >> 31);
  }
  double uniform(double lower, double upper) {
    return lower + (upper - lower) * static_cast<double>(word() >> 11) * 0x1p-53;
  }
  Vec3 in_cube(double half) {
    const double x = uniform(-half, half), y = uniform(-half, half), z = uniform(-half, half);
    return {x, y, z};
  }
  Vec3 direction() {
    for (;;) {
      const Vec3 a = in_cube(1.0);
      const double n = norm(a);
      if (n > 0.1 && n < 1.0) return (1.0 / n) * a;
    }
  }
  Mat3 rotation() {
    const double angle = uniform(0.0, kPi);
    return Exp(angle * direction()).matrix();
  }
  SE3 pose(double half) {
    const Mat3 R = rotation();
    return {R, in_cube(half)};
  }

 private:
  std::uint64_t state_;
};

}  // namespace vp::test
