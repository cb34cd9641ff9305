// One row of a joint: its motor, one of its stops, or a locked coordinate.
#pragma once

#include <algorithm>
#include <cmath>

#include "solve/link_side.h"
#include "vphysics/lie.h"

namespace vp::solve {

inline constexpr std::uint32_t kNoPair = 0xffffffffu;

// A body's part of a row: the derivative of the residual by the velocity of the body's point
// (SolverBody::x) and by its angular velocity.
struct PairEnd {
  std::uint32_t body = 0;
  Vec3 linear, angular;
  // Prepared.
  bool moves = false;  // an impulse moves the body itself
  LinkSide side{};
};

// Additional data of a row of a joint between two bodies.
struct JointPair {
  PairEnd a, b;
  // At an instant: the error that the position correction removes, and the nonlinear part of the
  // residual's change over the step, as a speed.
  double error = 0.0, curve = 0.0;
  // In a sub-step: hard rows have no softness once everything has moved.
  bool relaxes = false;
  double relaxed_target = 0.0;
  double loss = 0.0;  // softness, as a fraction of the response to a unit impulse
  // Prepared: softness without `loss`; the response to a unit impulse of the position correction.
  double floor = 0.0, answer = 0.0;
  double position_impulse = 0.0;  // accumulated impulse of the position correction
  // A drive: impulse = -h (stiffness * drive_error + damping * (u - drive_speed)), within its
  // bounds.
  bool drives = false;
  double stiffness = 0.0, damping = 0.0, drive_error = 0.0, drive_speed = 0.0;
  Vec3 anchor;  // from b's point to the reference point of the joint's torque
  // Where the world stores the impulse.
  std::uint32_t joint = 0, row = 0;
  bool of_stop = false;
};

// An impulse in [lower, upper] such that speed + softness * impulse = target.
struct JointRow {
  std::uint32_t articulation = 0, dof = 0;
  std::uint32_t pair = kNoPair;  // for a joint between bodies: its index in the context
  double speed = 0.0;            // for a row of an articulation: before the solve
  double target = 0.0;
  double softness = 0.0;  // 0: hard
  double lower = 0.0, upper = 0.0;
  double impulse = 0.0;        // the value before the solve is the warm start, as is warm_start
  double warm_start = 0.0;     // of an articulation's row: for a second solve
  double* remember = nullptr;  // where the world stores the impulse for the next step; may be null
  // Prepared.
  LinkSide side{};                        // of an articulation's own joint
  double inverse_mass = 0.0, mass = 0.0;  // mass: with the row's softness
};

// Whether an impulse on this coordinate changes other coordinates.
inline bool is_coupled(const LinkSide& side) {
  for (std::uint32_t k = 1; k < side.depth; ++k) {
    if (side.rows[k] != 0.0) return true;
  }
  return false;
}

// The impulse that solves this row alone at the given speed.
inline double impulse_after(const JointRow& row, double impulse, double speed) {
  return std::clamp(impulse + row.mass * (row.target - speed - row.softness * impulse), row.lower,
                    row.upper);
}

}  // namespace vp::solve
