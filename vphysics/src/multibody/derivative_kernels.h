// The passes of the derivatives, compiled for several instruction sets like those of kernels.h.
// Each set gives the same bits, except for fused multiply-add. Only addresses are passed between
// the namespaces.
#pragma once

#include "multibody/kernels.h"

namespace vphysics_kernels {
inline namespace VP_KERNELS_LIBRARY {

// tree, work and memory: Tree, Work and DerivativesWork; the work has the results of inverse or
// forward dynamics at the same state. The others as in derivatives.h. Results: derivatives with
// respect to q, v, and a or tau.
struct DerivativeArguments {
  const void* tree;
  void* work;
  void* memory;
  const void *q, *v, *a;
  const void* gravity;
  const void* external;  // one for each link, or null
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

}  // namespace VP_KERNELS_LIBRARY
}  // namespace vphysics_kernels
