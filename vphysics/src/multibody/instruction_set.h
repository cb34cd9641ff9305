// Which of the instruction sets that the kernels are compiled for is this machine's widest.
#pragma once

namespace vp::detail {

enum class InstructionSet { baseline, avx2, avx512 };

inline InstructionSet best_instruction_set() {
#ifdef VP_INSTRUCTION_SETS
  __builtin_cpu_init();
  if (__builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512vl") &&
      __builtin_cpu_supports("avx512dq") && __builtin_cpu_supports("avx512bw") &&
      __builtin_cpu_supports("bmi2")) {
    return InstructionSet::avx512;
  }
  if (__builtin_cpu_supports("avx2") && __builtin_cpu_supports("bmi2")) {
    return InstructionSet::avx2;
  }
#endif
  return InstructionSet::baseline;
}

}  // namespace vp::detail
