// The factors of one degree of freedom, with the symbols of impulse_factor.h.
#pragma once

#include "vphysics/lie/se3.h"

namespace vp::detail {

struct FactorColumn {
  se3 S, s;
  dse3 G;
  double g;
};

}  // namespace vp::detail
