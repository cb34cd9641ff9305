// The passes, compiled for several instruction sets, and the selection among them at program start:
// docs/decisions/0012.
//
// The baseline gives the same bits everywhere. The wider sets have fused multiply-add and round
// differently. kernels.cpp is compiled once for each set, in a separate namespace, so that the
// linker cannot merge inline functions of different sets. Only addresses are passed between the
// namespaces. vphysics and vphysics_packs have tables of their own, in an inline namespace each.
#pragma once

#include <array>
#include <cstddef>

#ifdef VP_PACKS
#define VP_KERNELS_LIBRARY packs
#else
#define VP_KERNELS_LIBRARY numbers
#endif

namespace vphysics_kernels {
inline namespace VP_KERNELS_LIBRARY {

// The arguments of a call of dynamics.h; unused ones are null. The lengths are those of the tree.
struct Arguments {
  const void* tree;
  void* work;
  const void* q = nullptr;
  const void* v = nullptr;
  const void* given = nullptr;  // tau of forward dynamics, a of inverse dynamics
  const void* gravity = nullptr;
  const void* external = nullptr;  // one for each link, or null
  void* out = nullptr;
};
using Kernel = bool (*)(const Arguments&);

struct Kernels {
  Kernel kinematics, forward_dynamics, factor_mass, solve_mass, inverse_dynamics, mass_matrix;
};
// One for each scalar, in the order of VP_FOR_EACH_SCALAR (instantiate.h).
#ifndef VP_PACKS
inline constexpr std::size_t kScalars = 2;
#elif defined(VP_FEW_SCALARS)
inline constexpr std::size_t kScalars = 1;
#else
inline constexpr std::size_t kScalars = 4;
#endif

using Table = std::array<Kernels, kScalars>;

extern const Table kBaseline;
// Only in libraries built with VP_INSTRUCTION_SETS.
extern const Table kAvx2;
extern const Table kAvx512;
// For double only, without fused multiply-add and in the order of the baseline: the same bits.
extern const Kernels kAvx2SameBits;
extern const Kernels kAvx512SameBits;

}  // namespace VP_KERNELS_LIBRARY
}  // namespace vphysics_kernels
