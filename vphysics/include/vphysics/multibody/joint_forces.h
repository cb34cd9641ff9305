// Springs, soft limits and motors as forces, for whoever integrates the equations of motion.
//
// These depend on the state alone, and must be resolved by the integrator's step: short against
// sqrt(m / k). Dry friction and stops are no such functions; constrained_step (constrained_step.h)
// has them, and takes all of these implicitly, so that no stiffness is too much for it.
#pragma once

#include <limits>
#include <span>

#include "vphysics/multibody/model.h"

namespace vp {

// A motor in one velocity of a joint, told anew for each step: stiffness and damping pull towards
// the targets, never with more than max_force nor the joint's motor_limit. All zero: no motor.
template <class T>
struct MotorT {
  T position{}, velocity{};  // targets; a ball's and a free joint's motors have no position
  T stiffness{}, damping{};  // [N/m], [N s/m]; [N m/rad], [N m s/rad]
  T max_force = T(std::numeric_limits<base_t<T>>::infinity());  // [N], [N m]
};
using Motor = MotorT<double>;

// tau += the forces of springs, limits that are no stops, and motors (none, or one for each
// velocity). Viscous damping is already in the dynamics. Scalars as in dynamics.h.
template <class T>
void joint_forces(const ModelT<base_t<T>>& model, std::span<const T> q, std::span<const T> v,
                  std::span<const MotorT<T>> motors, std::span<T> tau);

}  // namespace vp
