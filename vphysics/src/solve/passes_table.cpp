// Selects the instruction set for this machine.
#include "cpu_level.h"
#include "solve/dense_passes.h"
#include "solve/passes.h"

namespace vp::solve {
namespace {

struct Tables {
  const Passes* contacts;
  const AllJointPasses* joints;
  const vphysics_dense::Passes* dense;
};

Tables best() {
#ifdef VP_INSTRUCTION_SETS
  const CpuLevel level = cpu_level();
  if (level == CpuLevel::avx512) return {&kAvx512, &kAvx512Joints, &vphysics_dense::kAvx512};
  if (level == CpuLevel::avx2) return {&kAvx2, &kAvx2Joints, &vphysics_dense::kAvx2};
#endif
  return {&kBaseline, &kBaselineJoints, &vphysics_dense::kBaseline};
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
const vphysics_dense::Passes& dense_passes() {
  return *tables().dense;
}

}  // namespace vp::solve
