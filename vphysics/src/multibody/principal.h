// Principal moments and axes of a symmetric matrix.
#pragma once

#include <array>

#include "vphysics/lie/inertia.h"

namespace vp::detail {

struct Principal {
  std::array<double, 3> moments;  // in ascending order
  std::array<Vec3, 3> axes;       // unit vectors, in the order of the moments
};
Principal principal_of(const Sym3& A);

}  // namespace vp::detail
