// One step of a tree with all that its joints and constraints do: springs, dampers, Coulomb
// friction, limits, motors of bounded force, closed loops.
//
//   M (v+ - v) = h (tau - h(q, v)) + J^T lambda + p,   q+ = q [+] h v+
//
// Semi-implicit Euler, first order. Each joint's p and its v+ obey its force law at the step's end:
//   spring, damper, motor   implicit: stable however stiff; the motor is cut off at its bound
//   dry friction            sticks at exactly zero, or slides against exactly its bound
//   stop                    v+ reaches it and no more; nothing bounces
// All laws of the tree are solved together, exactly (Newton), not by a number of sweeps. Afterwards
// q+ is brought back onto the constraints, and v+ onto their tangent, joints that stick or stand at
// a stop staying where they are.
#pragma once

#include <span>

#include "vphysics/multibody/constrained_dynamics.h"
#include "vphysics/multibody/joint_forces.h"

namespace vp {

struct StepReport {
  int iterations = 0;     // of Newton's method over the laws
  bool converged = true;  // false: the laws are met to 1e-3 only, not to rounding
};

// Replaces q and v by those h [s] later. tau: forces on top of what the model and the motors do;
// motors: none, or one for each velocity. With no constraints, data is made of ConstraintSet{}.
//
// Refused, q and v being then unspecified: a step that is not positive, motors whose numbers are
// negative or not finite (Errc::invalid_argument); singular inertias, constraints and stops that
// contradict each other, loops that cannot be closed any more (Errc::singular).
Expected<StepReport> constrained_step(const Model& model, ConstrainedData& data,
                                      std::span<double> q, std::span<double> v,
                                      std::span<const double> tau, std::span<const Motor> motors,
                                      const Loads& loads, double h);

// Of the last step, a force for each velocity, as the mean over the step [N], [N m]: of all laws
// together, and of the motors alone.
std::span<const double> force_law_forces(const ConstrainedData& data);
std::span<const double> motor_forces(const ConstrainedData& data);

}  // namespace vp
