// Before an engine is timed it must have the scenes right: masses, gravity, friction, joints.
#pragma once

#include "measure.h"

namespace rigid {

// How far an engine was off on the scenes whose end is known.
struct Agreement {
  std::string engine;
  double worst = 0.0;          // [m]
  std::string wrong{};         // the first thing that it has wrong; empty: none
  std::string wrong_joints{};  // the same of joints; or why it was not asked
};
std::vector<Agreement> agreement(const Plan& plan);
std::string agreement_table(const std::vector<Agreement>& all);
// The plan, in which who has it wrong is told why it is left out.
Plan of_those_who_agree(Plan plan, const std::vector<Agreement>& all);

}  // namespace rigid
