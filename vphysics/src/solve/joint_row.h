// One coordinate of a joint: its motor, one of its stops, or what it holds.
#pragma once

#include <algorithm>
#include <cmath>

#include "solve/link_side.h"
#include "vphysics/lie.h"

namespace vp::solve {

inline constexpr std::uint32_t kNoPair = 0xffffffffu;

// A body's part of a row: how fast the residual grows by the velocity of its point (SolverBody::x)
// and by its angular velocity.
struct PairEnd {
  std::uint32_t body = 0;
  Vec3 linear, angular;
  // Prepared.
  bool moves = false;  // an impulse moves the body itself
  LinkSide side{};
};

// What a row of a joint between two bodies has more than one of a tree's own joint.
struct JointPair {
  PairEnd a, b;
  // Of an instant: the error that is taken out by moving the bodies, and how fast it grows of
  // itself on the way.
  double error = 0.0, curve = 0.0;
  // Of a sub-step: what holds hard has nothing that gives way once everything has moved.
  bool relaxes = false;
  double relaxed_target = 0.0;
  double loss = 0.0;  // softness, as a share of what a unit impulse does
  // Prepared: softness without it; what a unit impulse of the position correction counts.
  double floor = 0.0, answer = 0.0;
  double position_impulse = 0.0;  // of the position correction so far
  // A drive: impulse = -h (stiffness * drive_error + damping * (u - drive_speed)), in its bounds.
  bool drives = false;
  double stiffness = 0.0, damping = 0.0, drive_error = 0.0, drive_speed = 0.0;
  Vec3 anchor;  // from b's point to that about which the joint's torque is
  // Where the world keeps its impulse.
  std::uint32_t joint = 0, row = 0;
  bool of_stop = false;
};

// An impulse in [lower, upper] so that speed + softness * impulse = target.
struct JointRow {
  std::uint32_t articulation = 0, dof = 0;
  std::uint32_t pair = kNoPair;  // of a joint between bodies: its number in the context
  double speed = 0.0;            // of a tree's own joint, before the solve
  double target = 0.0;
  double softness = 0.0;  // 0: hard
  double lower = 0.0, upper = 0.0;
  double impulse = 0.0;        // before the solve: the warm start
  double* remember = nullptr;  // where the world keeps the impulse for the next step; may be null
  // Prepared.
  LinkSide side{};                        // of a tree's own joint
  double inverse_mass = 0.0, mass = 0.0;  // the latter of the row with its softness
};

// Whether an impulse on this coordinate moves others.
inline bool feels_others(const LinkSide& side) {
  for (std::uint32_t k = 1; k < side.depth; ++k) {
    if (side.rows[k] != 0.0) return true;
  }
  return false;
}

// The impulse that sets the row right at that speed, by the row alone.
inline double impulse_after(const JointRow& row, double impulse, double speed) {
  return std::clamp(impulse + row.mass * (row.target - speed - row.softness * impulse), row.lower,
                    row.upper);
}

}  // namespace vp::solve
