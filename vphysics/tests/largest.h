// The largest absolute value of a vector's components.
#pragma once

#include <algorithm>
#include <cmath>

#include "vphysics/lie.h"

namespace vp::test {

inline double largest(const Vec3& a) {
  return std::max({std::fabs(a.x), std::fabs(a.y), std::fabs(a.z)});
}

}  // namespace vp::test
