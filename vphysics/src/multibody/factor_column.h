// A degree of freedom as ImpulseFactor has it (impulse_factor.h).
#pragma once

#include "vphysics/lie/se3.h"

namespace vp::detail {

struct FactorColumn {
  se3 S, s;
  dse3 G;
  double g;
};

}  // namespace vp::detail
