// The inner passes of the derivatives, compiled for several instruction sets as those of kernels.h
// are: with the same bits from each, and nothing but addresses between the namespaces.
#pragma once

#include <cstddef>

namespace vphysics_kernels {

// tree, work and memory: Tree, Work and DerivativesWork; the others as in derivatives.h.
struct DifferentiateArguments {
  const void* tree;
  const void* work;
  void* memory;
  const void *q, *v, *a;
  const void* loads;
  const void* matrices;  // InverseMatrices
};
struct SolveArguments {
  void* memory;
  std::size_t velocities;
  void *a_q, *a_v, *a_tau;
};

struct DerivativeKernels {
  bool (*differentiate)(const DifferentiateArguments&);
  bool (*solve)(const SolveArguments&);
};

// Of double and of float.
extern const DerivativeKernels kBaselineDerivatives[2];
// Only in libraries built with VP_INSTRUCTION_SETS.
extern const DerivativeKernels kAvx2Derivatives[2];
extern const DerivativeKernels kAvx512Derivatives[2];

}  // namespace vphysics_kernels
