#include "world/implicit_forces.h"

#include <algorithm>
#include <cmath>

namespace vp {
namespace {

// A motor whose last impulse was a larger fraction of its limit is a row from the start.
constexpr double kFarFromLimit = 0.9;

}  // namespace

void ImplicitForces::clear() {
  if (!any_) return;
  any_ = false;
  std::fill(forces_.begin(), forces_.end(), Force{});
  std::fill(gains_.begin(), gains_.end(), 0.0);
}

void ImplicitForces::choose(double dt, std::span<const JointDof> dofs, std::span<const double> q) {
  any_ = false;
  for (std::size_t i = 0; i < dofs.size(); ++i) {
    const JointDof& dof = dofs[i];
    Force& f = forces_[i];
    const JointForces& forces = dof.forces;
    if (gains_[i] != 0.0) make_row(i);
    if (excluded_[i] || !(dof.drive.max_force > 0.0 || forces.stiffness > 0.0)) continue;
    const double x = dof.coordinate < 0 ? 0.0 : q[static_cast<std::size_t>(dof.coordinate)];
    f.motor = motor_of(dof, dt, x);
    if (std::fabs(dof.impulses[kMotorRow]) > kFarFromLimit * f.motor.limit) f.motor = {};
    if (dof.coordinate >= 0 && forces.stiffness > 0.0) {
      f.spring = {dt * forces.stiffness * (forces.rest - x), dt * dt * forces.stiffness, 0.0};
    }
    sum(i);
    any_ = any_ || gains_[i] > 0.0;
  }
}

void ImplicitForces::make_row(std::size_t dof) {
  forces_[dof] = {};
  gains_[dof] = 0.0;
}

}  // namespace vp
