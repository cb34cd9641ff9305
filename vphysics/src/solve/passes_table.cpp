// Which of the instruction sets this machine has.
#include "solve/passes.h"

namespace vp::solve {
namespace {

const Passes& best() {
#ifdef VP_INSTRUCTION_SETS
  __builtin_cpu_init();
  const bool avx2 = __builtin_cpu_supports("avx2");
  if (avx2 && __builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512vl") &&
      __builtin_cpu_supports("avx512dq") && __builtin_cpu_supports("avx512bw")) {
    return kAvx512;
  }
  if (avx2) return kAvx2;
#endif
  return kBaseline;
}

}  // namespace

const Passes& passes() {
  static const Passes& chosen = best();
  return chosen;
}

}  // namespace vp::solve
