// The passes of the derivatives, compiled for several instruction sets as those of kernels.h are:
// with the same bits from each but for fused multiply-add, and nothing but addresses between the
// namespaces.
#pragma once

#include "multibody/kernels.h"

namespace vphysics_kernels {

// tree, work and memory: Tree, Work and DerivativesWork, the work as inverse or forward dynamics
// of the same state has left it; the others as in derivatives.h. The results by q, by v, and by a
// or tau.
struct DerivativeArguments {
  const void* tree;
  void* work;
  void* memory;
  const void *q, *v, *a;
  const void* gravity;
  const void* external;  // of each link, or null
  void *by_q, *by_v, *by_force;
};
enum class Differentiated { done, no_derivatives, singular };

struct DerivativeKernels {
  Differentiated (*inverse)(const DerivativeArguments&);
  Differentiated (*forward)(const DerivativeArguments&);
};
using DerivativeTable = std::array<DerivativeKernels, kScalars>;

extern const DerivativeTable kBaselineDerivatives;
// Only in libraries built with VP_INSTRUCTION_SETS.
extern const DerivativeTable kAvx2Derivatives;
extern const DerivativeTable kAvx512Derivatives;

}  // namespace vphysics_kernels
