// Selects the instruction set of the kernels that a data uses.
#pragma once

#include <cstdint>

#include "cpu_level.h"
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
inline InstructionSet instruction_set_for(Arithmetic arithmetic) {
  const bool same_bits = arithmetic == Arithmetic::reproducible;
  switch (cpu_level()) {
    case CpuLevel::avx512:
      return same_bits ? InstructionSet::avx512_same_bits : InstructionSet::avx512;
    case CpuLevel::avx2:
      return same_bits ? InstructionSet::avx2_same_bits : InstructionSet::avx2;
    case CpuLevel::baseline:
      break;
  }
  return InstructionSet::baseline;
}

}  // namespace vp::detail
