// Springs, soft limits and motors as explicit forces, for explicit integrators.
//
// These forces depend on the state alone. The integrator's step must resolve them: it must be short
// compared with sqrt(m / k). Dry friction and stops are not functions of the state.
// constrained_step (constrained_step.h) supports them, and treats all of these forces implicitly,
// so that it is stable at any stiffness.
#pragma once

#include <limits>
#include <span>

#include "vphysics/multibody/model.h"

namespace vp {

// A motor in one velocity of a joint, set for each step. Stiffness and damping drive the joint to
// the targets. The force is limited by max_force and by the joint's motor_limit. All zero: no
// motor.
template <class T>
struct MotorT {
  T position{}, velocity{};  // targets; motors of ball and free joints use no position
  T stiffness{}, damping{};  // [N/m], [N s/m]; [N m/rad], [N m s/rad]
  T max_force = T(std::numeric_limits<base_t<T>>::infinity());  // [N], [N m]
};
using Motor = MotorT<double>;

// Adds to tau the forces of springs, soft limits, and motors (empty, or one for each velocity).
// Viscous damping is already in the dynamics. Scalars as in dynamics.h.
template <class T>
void joint_forces(const ModelT<base_t<T>>& model, std::span<const T> q, std::span<const T> v,
                  std::span<const MotorT<T>> motors, std::span<T> tau);

}  // namespace vp
