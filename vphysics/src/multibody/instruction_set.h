// Selects the instruction set of the kernels that a data uses.
#pragma once

#include <cstdint>

#include "vphysics/multibody/data.h"

namespace vp::detail {

enum class InstructionSet : std::uint8_t {
  baseline,
  avx2,
  avx512,
  avx2_same_bits,
  avx512_same_bits
};

// The wider sets use fused multiply-add and therefore round differently: not for reproducible
// results.
inline InstructionSet instruction_set_for([[maybe_unused]] Arithmetic arithmetic) {
#ifdef VP_INSTRUCTION_SETS
  const bool same_bits = arithmetic == Arithmetic::reproducible;
  __builtin_cpu_init();
  const bool avx2 = __builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma") &&
                    __builtin_cpu_supports("bmi2");
  if (avx2 && __builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512vl") &&
      __builtin_cpu_supports("avx512dq") && __builtin_cpu_supports("avx512bw")) {
    return same_bits ? InstructionSet::avx512_same_bits : InstructionSet::avx512;
  }
  if (avx2) return same_bits ? InstructionSet::avx2_same_bits : InstructionSet::avx2;
#endif
  return InstructionSet::baseline;
}

}  // namespace vp::detail
