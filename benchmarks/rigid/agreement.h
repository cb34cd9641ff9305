// Checks before timing that each engine simulates the scenes correctly: masses, gravity, friction,
// joints.
#pragma once

#include "measure.h"

namespace rigid {

// The errors of an engine on the scenes with a known final state.
struct Agreement {
  std::string engine;
  double worst = 0.0;          // [m]
  std::string wrong{};         // the first error beyond its tolerance; empty: none
  std::string wrong_joints{};  // the same for joints, or why they were not tested
};
std::vector<Agreement> agreement(const Plan& plan);
std::string agreement_table(const std::vector<Agreement>& all);
// The plan without the engines that have errors; it gives the reasons.
Plan of_those_who_agree(Plan plan, const std::vector<Agreement>& all);

}  // namespace rigid
