// One degree of freedom of an articulation: its limits, forces and motor.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>

#include "vphysics/multibody/joint.h"
#include "vphysics/world_joints.h"

namespace vp {

// The solver rows that a degree of freedom may have.
enum RowOfDof : std::uint8_t {
  kMotorRow,
  kFrictionRow,  // a lock if the friction is infinite
  kSpringRow,
  kLowerRow,  // limits: stops or springs
  kUpperRow,
  kRowsOfDof
};

// One degree of freedom.
struct JointDof {
  int coordinate = -1;  // index in q; -1 for ball and free joints
  JointForces forces;
  double lower = -1e30, upper = 1e30;  // stops
  bool locked = false;                 // by infinite friction
  bool passive = false;                // has a spring, friction, or compliant limits
  JointDrive drive;
  // Impulses of its rows in the last step: the warm start of the next solve.
  std::array<double, kRowsOfDof> impulses{};
};

// The motor of a degree of freedom over h. With f = k (p - q - h v) + d (v_t - v) its impulse is
// constant - gain v, v being the velocity after it, clamped to +-limit. Without a motor all are 0.
struct Motor {
  double constant = 0.0, gain = 0.0, limit = 0.0;
};
inline Motor motor_of(const JointDof& dof, double h, double position) {
  const JointDrive& d = dof.drive;
  const double limit = h * std::min(d.max_force, dof.forces.motor_limit);
  const double gain = h * (h * d.stiffness + d.damping);
  if (!(gain > 0.0 && limit > 0.0)) return {};
  return {h * (d.stiffness * (d.position - position) + d.damping * d.velocity), gain, limit};
}

}  // namespace vp
