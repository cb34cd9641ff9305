// What was measured, as tables, as rows for the file, and beside the goals.
#pragma once

#include <string>
#include <vector>

#include "compile_cost.h"
#include "measure.h"

namespace vp::bench {

// Something to reach, and whether it was.
struct Goal {
  std::string subject, metric;  // metric: "forward_of_mujoco"
  std::string what;             // in words
  double value, bound;
  const char* unit;
  bool met() const { return value <= bound; }
};
// Those whose figures are there.
std::vector<Goal> goals(const std::vector<Figure>& figures, const CompileCost* compile);

std::string agreement_table(const std::vector<Figure>& figures, const Plan& plan);
std::string times_table(const std::vector<Figure>& figures, const Plan& plan);
std::string batch_table(const std::vector<Figure>& figures, const Plan& plan);
std::string goals_table(const std::vector<Goal>& goals);
// subject,engine,metric,value,unit; what a goal wants has the engine "goal".
std::string csv(const std::vector<Figure>& figures, const std::vector<Goal>& goals);

}  // namespace vp::bench
