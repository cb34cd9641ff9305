#include "vphysics/step_report.h"

#include <cstddef>
#include <iterator>

namespace vp {

StepStatus& StepStatus::operator|=(const StepStatus& other) {
  impact_limit |= other.impact_limit;
  non_finite |= other.non_finite;
  bounce_limit |= other.bounce_limit;
  manifold_limit |= other.manifold_limit;
  distance_limit |= other.distance_limit;
  colour_limit |= other.colour_limit;
  position_error |= other.position_error;
  time_lost += other.time_lost;
  return *this;
}

namespace {

struct Report {
  bool StepStatus::*flag;
  const char* sentence;
};
// Indexed by Limit.
constexpr Report kReports[] = {
    {&StepStatus::impact_limit,
     "a continuous body had more impacts than a step resolves and was stopped: use a shorter step "
     "or raise max_impacts_per_step"},
    {&StepStatus::non_finite,
     "a body left the range of numbers and was stopped: look for forces, springs or speeds "
     "that are too large for the step"},
    {&StepStatus::bounce_limit,
     "restitution propagated through more bodies than a sub-step has iterations, and the remaining "
     "approach speeds were stopped: use more sub-steps or less restitution"},
    {&StepStatus::manifold_limit,
     "a shape touched a surface with too many different normals, and some were merged: use a "
     "coarser surface or a smaller shape"},
    {&StepStatus::distance_limit,
     "the penetration depth of two shapes was not found exactly: use less flat shapes or a "
     "shorter step"},
    {&StepStatus::colour_limit,
     "a body has more contacts than can be solved in parallel: the step takes longer"},
    {&StepStatus::position_error,
     "shapes overlap deeply, or a joint is far open: look for joints that contradict one "
     "another and for large mass ratios, or use more sub-steps"},
};
const Report* report_of(Limit limit) {
  const auto index = static_cast<std::size_t>(limit);
  return index < std::size(kReports) ? &kReports[index] : nullptr;
}

}  // namespace

bool reached(const StepStatus& status, Limit limit) {
  const Report* report = report_of(limit);
  return report && status.*report->flag;
}

const char* sentence(Limit limit) {
  const Report* report = report_of(limit);
  return report ? report->sentence : "";
}

}  // namespace vp
