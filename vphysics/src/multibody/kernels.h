// The passes, compiled for several instruction sets, and the choice among them when the program
// starts: docs/decisions/0012.
//
// The baseline gives the same bits everywhere; the wider sets have fused multiply-add and give
// their own, but for those that are compiled without it (VP_SAME_BITS). kernels.cpp is compiled
// once for each set, in a namespace of its own, so that the linker can never take an inline
// function of one for another's. What crosses between the namespaces is this header's: addresses.
#pragma once

#include <array>
#include <cstddef>

namespace vphysics_kernels {

// Of the arguments of a call of dynamics.h those that it has; lengths are the tree's.
struct Arguments {
  const void* tree;
  void* work;
  const void* q = nullptr;
  const void* v = nullptr;
  const void* given = nullptr;  // tau of forward dynamics, a of inverse
  const void* gravity = nullptr;
  const void* external = nullptr;  // of each link, or null
  void* out = nullptr;
};
using Kernel = bool (*)(const Arguments&);

struct Kernels {
  Kernel kinematics, forward_dynamics, factor_mass, solve_mass, inverse_dynamics, mass_matrix;
};
// One for each scalar, in the order of VP_FOR_EACH_SCALAR (instantiate.h).
#ifdef VP_FEW_SCALARS
inline constexpr std::size_t kScalars = 3;
#else
inline constexpr std::size_t kScalars = 6;
#endif

using Table = std::array<Kernels, kScalars>;

extern const Table kBaseline;
// Only in libraries built with VP_INSTRUCTION_SETS.
extern const Table kAvx2;
extern const Table kAvx512;
// Of double alone, without fused multiply-add and in the order of the baseline: its bits.
extern const Kernels kAvx2SameBits;
extern const Kernels kAvx512SameBits;

}  // namespace vphysics_kernels
