// Selects the instruction set for this machine.
#include "solve/passes.h"

namespace vp::solve {
namespace {

struct Tables {
  const Passes* contacts;
  const AllJointPasses* joints;
};

Tables best() {
#ifdef VP_INSTRUCTION_SETS
  __builtin_cpu_init();
  const bool avx2 = __builtin_cpu_supports("avx2");
  if (avx2 && __builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512vl") &&
      __builtin_cpu_supports("avx512dq") && __builtin_cpu_supports("avx512bw")) {
    return {&kAvx512, &kAvx512Joints};
  }
  if (avx2) return {&kAvx2, &kAvx2Joints};
#endif
  return {&kBaseline, &kBaselineJoints};
}

const Tables& tables() {
  static const Tables chosen = best();
  return chosen;
}

}  // namespace

const Passes& passes() {
  return *tables().contacts;
}
const AllJointPasses& joint_passes() {
  return *tables().joints;
}

}  // namespace vp::solve
