// Selects among kernels that are compiled for several instruction sets.
#pragma once

#include <cstdint>

namespace vp {

// Each level contains those before it: avx2 with FMA and BMI2; avx512 with F, VL, DQ and BW.
enum class CpuLevel : std::uint8_t { baseline, avx2, avx512 };

// The highest level of this machine for which there are kernels.
inline CpuLevel cpu_level() {
#ifdef VP_INSTRUCTION_SETS
  __builtin_cpu_init();
  const bool avx2 = __builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma") &&
                    __builtin_cpu_supports("bmi2");
  if (avx2 && __builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512vl") &&
      __builtin_cpu_supports("avx512dq") && __builtin_cpu_supports("avx512bw")) {
    return CpuLevel::avx512;
  }
  if (avx2) return CpuLevel::avx2;
#endif
  return CpuLevel::baseline;
}

}  // namespace vp
