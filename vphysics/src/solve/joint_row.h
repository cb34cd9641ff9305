// One coordinate of a joint: its motor or one of its stops.
#pragma once

#include <algorithm>
#include <cmath>

#include "solve/link_side.h"

namespace vp::solve {

// An impulse in [lower, upper] so that speed + softness * impulse = target.
struct JointRow {
  std::uint32_t articulation = 0, dof = 0;
  double speed = 0.0;  // before the solve
  double target = 0.0;
  double softness = 0.0;  // 0: hard
  double lower = 0.0, upper = 0.0;
  double impulse = 0.0;        // before the solve: the warm start
  double* remember = nullptr;  // where the world keeps the impulse for the next step; may be null
  // Prepared.
  LinkSide side{};
  double inverse_mass = 0.0, mass = 0.0;  // the latter of the row with its softness
};

// Whether an impulse on this coordinate moves others.
inline bool feels_others(const LinkSide& side) {
  for (std::uint32_t k = 1; k < side.depth; ++k) {
    if (side.rows[k] != 0.0) return true;
  }
  return false;
}

// Returns the change of speed.
inline double solve_joint(JointRow& row) {
  const double speed = row.speed + along(row.side, 0, row.side.velocity);
  const double error = row.target - speed - row.softness * row.impulse;
  const double next = std::clamp(row.impulse + row.mass * error, row.lower, row.upper);
  const double change = next - row.impulse;
  row.impulse = next;
  push(row.side, 0, change, row.side.velocity);
  return row.inverse_mass * std::fabs(change);
}

}  // namespace vp::solve
