// Reports the results: tables, rows of a CSV file, and a comparison with the goals.
#pragma once

#include <string>
#include <vector>

#include "compile_cost.h"
#include "measure.h"

namespace vp::bench {

// A goal: an upper bound of a measured value.
struct Goal {
  std::string subject, metric;  // metric: "forward_of_mujoco"
  std::string what;             // in words
  double value, bound;
  const char* unit;
  bool met() const { return value <= bound; }
};
// The goals whose results have been measured.
std::vector<Goal> goals(const std::vector<Figure>& figures, const CompileCost* compile);

std::string agreement_table(const std::vector<Figure>& figures, const Plan& plan);
std::string times_table(const std::vector<Figure>& figures, const Plan& plan);
std::string batch_table(const std::vector<Figure>& figures, const Plan& plan);
std::string goals_table(const std::vector<Goal>& goals);
// subject,engine,metric,value,unit; the bounds of goals have the engine "goal".
std::string csv(const std::vector<Figure>& figures, const std::vector<Goal>& goals);

}  // namespace vp::bench
