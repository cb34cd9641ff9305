// Selects the instruction set of the kernels that a data uses.
#pragma once

#include <cstdint>

#include "vphysics/multibody/data.h"

namespace vp::detail {

enum class InstructionSet : std::uint8_t { baseline, avx2, avx512 };

// The wider sets use fused multiply-add and therefore round differently: not for reproducible
// results.
inline InstructionSet instruction_set_for([[maybe_unused]] Arithmetic arithmetic) {
#ifdef VP_INSTRUCTION_SETS
  if (arithmetic == Arithmetic::reproducible) return InstructionSet::baseline;
  __builtin_cpu_init();
  const bool avx2 = __builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma") &&
                    __builtin_cpu_supports("bmi2");
  if (avx2 && __builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512vl") &&
      __builtin_cpu_supports("avx512dq") && __builtin_cpu_supports("avx512bw")) {
    return InstructionSet::avx512;
  }
  if (avx2) return InstructionSet::avx2;
#endif
  return InstructionSet::baseline;
}

}  // namespace vp::detail
