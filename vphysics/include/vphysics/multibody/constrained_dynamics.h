// The equations of motion of a tree under constraints (constraint.h):
//
//   M(q) a + h(q, v) = tau + J^T lambda,   J a + b = 0
//
// solved through the articulated recursion: M^-1 J^T row by row, O(links) each; then
// (J M^-1 J^T) lambda = ..., in factors that tell which rows depend on others. So redundant
// constraints are fine (a planar linkage closed by a hinge has three rows too many; their lambda is
// zero), and mechanisms pass singular positions. Constraints that contradict each other give an
// error.
//
// Everything is in double: a loop closed to 1e-12 has no use for float. Preconditions (asserted):
// lengths are the model's, the data was made for the model. Nothing is allocated but the message of
// an error. Errors: Errc::singular, after which the results are unspecified and finite or not.
#pragma once

#include <memory>
#include <span>
#include <vector>

#include "vphysics/multibody/constraint.h"
#include "vphysics/multibody/dynamics.h"

namespace vp {

namespace detail {
struct ConstraintWork;
}

// Memory for a model under constraints, the constraints themselves, and what the calls leave: 48
// (rows + velocities)^2 bytes at most.
class ConstrainedData {
 public:
  ConstrainedData(const Model& model, ConstraintSet constraints);
  ~ConstrainedData();
  ConstrainedData(ConstrainedData&&) noexcept;
  ConstrainedData& operator=(ConstrainedData&&) noexcept;

  // Of the last call: poses and velocities of links (dynamics.h).
  Data& links();
  // phi and J (rows x velocities, row by row), and the multipliers lambda of
  // constrained_forward_dynamics: forces along the rows.
  std::span<const double> residual() const;
  std::span<const double> jacobian() const;
  std::span<const double> bias() const;
  std::span<const double> multipliers() const;
  // How many of the rows were independent when last solved for.
  int rank() const;

  detail::ConstraintWork& work() { return *work_; }
  const detail::ConstraintWork& work() const { return *work_; }

 private:
  std::unique_ptr<detail::ConstraintWork> work_;
};

// phi, J and b at q and v.
void evaluate_constraints(const Model& model, ConstrainedData& data, std::span<const double> q,
                          std::span<const double> v);

// a from tau. With a rate r > 0 [1/s], phi'' + 2 r phi' + r^2 phi = 0 instead of phi'' = 0
// (Baumgarte), so that errors of q and v fade; what closes loops to rounding is close_loops.
// Refused: constraints without a solution, and singular inertias as in forward_dynamics.
Expected<void> constrained_forward_dynamics(const Model& model, ConstrainedData& data,
                                            std::span<const double> q, std::span<const double> v,
                                            std::span<const double> tau, const Loads& loads,
                                            double rate, std::span<double> a);

struct ClosureOptions {
  double tolerance = 1e-12;  // of every residual
  int max_steps = 50;
  // Numbers of velocities whose coordinates stay: a driven crank, joints that are locked.
  std::span<const int> held{};
};

// Moves q onto phi(q) = 0 by Newton's method on the group, each step the least that does it by the
// measure of kinetic energy; from near, the error is squared each time. Returns the steps taken.
// Refused: when it cannot be closed from here; q is then the nearest that was found.
Expected<int> close_loops(const Model& model, ConstrainedData& data, std::span<double> q,
                          const ClosureOptions& options = {});

// v <- the velocities with J v = 0 that are nearest by the measure of kinetic energy: what an
// impact of the constraints makes of v.
Expected<void> project_velocities(const Model& model, ConstrainedData& data,
                                  std::span<const double> q, std::span<double> v);

}  // namespace vp
