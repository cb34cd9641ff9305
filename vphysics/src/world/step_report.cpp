#include "vphysics/step_report.h"

namespace vp {

StepStatus& StepStatus::operator|=(const StepStatus& other) {
  impact_limit |= other.impact_limit;
  non_finite |= other.non_finite;
  bounce_limit |= other.bounce_limit;
  manifold_limit |= other.manifold_limit;
  distance_limit |= other.distance_limit;
  colour_limit |= other.colour_limit;
  position_error |= other.position_error;
  time_held += other.time_held;
  return *this;
}

bool reached(const StepStatus& status, Limit limit) {
  switch (limit) {
    case Limit::impacts:
      return status.impact_limit;
    case Limit::range:
      return status.non_finite;
    case Limit::bounces:
      return status.bounce_limit;
    case Limit::manifolds:
      return status.manifold_limit;
    case Limit::distances:
      return status.distance_limit;
    case Limit::colours:
      return status.colour_limit;
    case Limit::positions:
      return status.position_error;
  }
  return false;
}

const char* sentence(Limit limit) {
  switch (limit) {
    case Limit::impacts:
      return "a swept body met more impacts than a step resolves and was held: shorten the step or "
             "raise max_impacts_per_step";
    case Limit::range:
      return "a body left the range of numbers and was stopped: look for forces, springs or speeds "
             "that are too large for the step";
    case Limit::bounces:
      return "bounces ran through more bodies than a sub-step's rounds and the rest were stopped: "
             "take more sub-steps or less restitution";
    case Limit::manifolds:
      return "a shape touched a surface at more slopes than are told apart: make the surface "
             "coarser, or the shape smaller";
    case Limit::distances:
      return "how deep two shapes overlap was not found exactly: make them less flat, or the step "
             "shorter";
    case Limit::colours:
      return "a body has more contacts than are solved side by side: the step takes longer";
    case Limit::positions:
      return "shapes overlap deeply, or a joint is far open: look for joints that contradict one "
             "another and for large ratios of mass, or take more sub-steps";
  }
  return "";
}

}  // namespace vp
