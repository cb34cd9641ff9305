// What a recording may hold, for the one who writes it and the one who reads it.
#pragma once

#include <optional>
#include <string>

#include "world/recorded_call.h"
#include "world/validate.h"

namespace vp::recording {

// Those that change the structure of the world; its digest follows them.
inline bool builds(const RecordedCall& call) {
  return call.what.index() <= RecordedCall::What(calls::DestroyJoint{}).index() ||
         std::holds_alternative<calls::SetMassFromColliders>(call.what);
}

// Each is far beyond what anybody simulates with, and bounds the time that a stranger's step takes.
inline std::optional<std::string> problem_with(const WorldDesc& desc) {
  const bool numbers = in_range(desc.gravity) && in_range(desc.restitution_threshold) &&
                       desc.restitution_threshold >= 0.0 && in_range(desc.contact_slop) &&
                       desc.contact_slop > 0.0 && in_range(desc.sleep_after) &&
                       in_range(desc.sleep_speed);
  const bool counts = desc.velocity_iterations > 0 && desc.velocity_iterations <= 1000 &&
                      desc.sub_steps >= 0 && desc.sub_steps <= 1000 &&
                      desc.max_impacts_per_step >= 0 && desc.max_impacts_per_step <= 100000;
  if (numbers && counts) return std::nullopt;
  return "the world's settings are beyond what a recording holds; at most 1000 iterations and "
         "sub-steps, 100000 impacts a step and numbers of 1e9";
}

}  // namespace vp::recording
