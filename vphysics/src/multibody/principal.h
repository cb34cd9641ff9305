// Principal moments and axes of a symmetric matrix.
#pragma once

#include <array>

#include "vphysics/lie/inertia.h"

namespace vp::detail {

struct Principal {
  std::array<double, 3> moments;  // the least first
  std::array<Vec3, 3> axes;       // unit vectors, of the moments in turn
};
Principal principal_of(const Sym3& A);

}  // namespace vp::detail
