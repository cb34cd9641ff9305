// One time step of a tree with its joint forces and constraints: springs, dampers, Coulomb
// friction, limits, motors with bounded force, closed loops.
//
//   M (v+ - v) = h (tau - h(q, v)) + J^T lambda + p,   q+ = q [+] h v+
//
// Semi-implicit Euler, first order. The impulse p and the velocity v+ of each joint satisfy the
// joint's force law at the end of the step:
//   spring, damper, motor   implicit: stable at any stiffness; the motor saturates at its bound
//   dry friction            sticks at exactly zero, or slides against exactly its bound
//   stop                    v+ reaches the stop and no further; no restitution
// Newton's method solves all force laws of the tree together, exactly, instead of a fixed number of
// Gauss-Seidel sweeps. Afterwards, q+ is projected onto the constraints and v+ onto their tangent
// space. Joints that stick or rest at a stop keep their coordinates.
#pragma once

#include <span>

#include "vphysics/multibody/constrained_dynamics.h"
#include "vphysics/multibody/joint_forces.h"

namespace vp {

struct StepReport {
  int iterations = 0;     // Newton iterations over the force laws
  bool converged = true;  // false: the force laws are satisfied to 1e-3 only, not to rounding
};

// Advances q and v by h [s]. tau: forces in addition to those of the model and the motors. motors:
// empty, or one for each velocity. Without constraints, make data with ConstraintSet{}.
//
// Errors, after which q and v are unspecified: a step that is not positive, or motors with negative
// or non-finite parameters (Errc::invalid_argument); singular inertias, constraints and stops that
// contradict each other, or loops that can no longer be closed (Errc::singular).
Expected<StepReport> constrained_step(const Model& model, ConstrainedData& data,
                                      std::span<double> q, std::span<double> v,
                                      std::span<const double> tau, std::span<const Motor> motors,
                                      const Loads& loads, double h);

// Forces of the last step, one for each velocity, averaged over the step [N], [N m]: of all force
// laws together, and of the motors alone.
std::span<const double> force_law_forces(const ConstrainedData& data);
std::span<const double> motor_forces(const ConstrainedData& data);

}  // namespace vp
