// Motors and springs of an articulation as part of its factored mass matrix.
//
// A motor below its limit and a spring are linear: over a step h their impulse is c - G v, v being
// the velocity at its end. So they are solved exactly with
//   (M + h D + G) dv = h (f - h(q, v) - D v) + c - G v
// and need no rows in the solver; contacts respond to their stiffness. Which motors are below their
// limit is predicted from their impulses in the last step. A motor that exceeds its limit after all
// becomes a row, and the step's forces are integrated again.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "world/joint_dof.h"

namespace vp {

class ImplicitForces {
 public:
  // excluded: degrees of freedom whose motors and springs are always rows.
  explicit ImplicitForces(std::size_t dofs) : excluded_(dofs), forces_(dofs), gains_(dofs) {}
  void exclude(std::size_t dof) { excluded_[dof] = 1; }

  // None: all are rows.
  void clear();
  // Chooses the motors and springs for a step dt at the coordinates q.
  void choose(double dt, std::span<const JointDof> dofs, std::span<const double> q);
  void make_row(std::size_t dof);  // its motor and its spring

  bool any() const { return any_; }
  bool has_motor(std::size_t dof) const { return any_ && forces_[dof].motor.limit > 0.0; }
  bool has_spring(std::size_t dof) const { return any_ && forces_[dof].spring.gain > 0.0; }
  const Motor& motor(std::size_t dof) const { return forces_[dof].motor; }
  const Motor& spring(std::size_t dof) const { return forces_[dof].spring; }
  // Of all degrees of freedom; empty without such forces.
  std::span<const double> gains() const {
    return any_ ? std::span<const double>(gains_) : std::span<const double>();
  }
  // c - G v
  double impulse(std::size_t dof, double v) const {
    const Force& f = forces_[dof];
    return (f.motor.constant + f.spring.constant) - gains_[dof] * v;
  }

 private:
  struct Force {
    Motor motor, spring;  // a spring has no limit
  };
  void sum(std::size_t dof) { gains_[dof] = forces_[dof].motor.gain + forces_[dof].spring.gain; }

  std::vector<std::uint8_t> excluded_;
  std::vector<Force> forces_;
  std::vector<double> gains_;
  bool any_ = false;
};

}  // namespace vp
