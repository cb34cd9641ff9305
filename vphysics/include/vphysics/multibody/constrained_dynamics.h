// The equations of motion of a tree under constraints (constraint.h):
//
//   M(q) a + h(q, v) = tau + J^T lambda,   J a + b = 0
//
// The articulated body recursion gives M^-1 J^T row by row, in O(links) each. A rank-revealing
// factorisation then solves (J M^-1 J^T) lambda = .... Redundant constraints are therefore allowed:
// a planar linkage closed by a hinge has three redundant rows, and their lambda is zero. Mechanisms
// may pass through singular configurations. Contradictory constraints return an error.
//
// Everything is in double: a loop closed to 1e-12 has no use for float. Preconditions (asserted):
// the lengths match the model; the data was made for the model. Calls allocate only the message of
// an error. Errors: Errc::singular; the results are then unspecified and may be non-finite.
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

// Memory for a model under constraints, the constraints, and the results of the calls. At most 48
// (rows + velocities)^2 bytes.
class ConstrainedData {
 public:
  ConstrainedData(const Model& model, ConstraintSet constraints);
  ~ConstrainedData();
  ConstrainedData(ConstrainedData&&) noexcept;
  ConstrainedData& operator=(ConstrainedData&&) noexcept;

  // Poses and velocities of the links (dynamics.h) of the last call.
  Data& links();
  // phi, J (rows x velocities, row by row), b, and the multipliers lambda of
  // constrained_forward_dynamics: the forces along the rows.
  std::span<const double> residual() const;
  std::span<const double> jacobian() const;
  std::span<const double> bias() const;
  std::span<const double> multipliers() const;
  // The number of independent rows in the last solve.
  int rank() const;

  detail::ConstraintWork& work() { return *work_; }
  const detail::ConstraintWork& work() const { return *work_; }

 private:
  std::unique_ptr<detail::ConstraintWork> work_;
};

// Computes phi, J and b at q and v.
void evaluate_constraints(const Model& model, ConstrainedData& data, std::span<const double> q,
                          std::span<const double> v);

// Computes a from tau. With a rate r > 0 [1/s] it solves phi'' + 2 r phi' + r^2 phi = 0 instead of
// phi'' = 0 (Baumgarte stabilisation), so that errors of q and v decay. To close loops to rounding,
// call close_loops. Fails on constraints without a solution, and on singular inertias as
// forward_dynamics does.
Expected<void> constrained_forward_dynamics(const Model& model, ConstrainedData& data,
                                            std::span<const double> q, std::span<const double> v,
                                            std::span<const double> tau, const Loads& loads,
                                            double rate, std::span<double> a);

struct ClosureOptions {
  double tolerance = 1e-12;  // of every residual
  int max_steps = 50;
  // Indices of velocities whose coordinates stay fixed: a driven crank, locked joints.
  std::span<const int> held{};
};

// Moves q onto phi(q) = 0 by Newton's method on the group. Each step has the minimum norm in the
// kinetic-energy metric. Close to the solution, convergence is quadratic. Returns the number of
// steps. Fails when the loops cannot be closed from q; q is then the closest configuration found.
Expected<int> close_loops(const Model& model, ConstrainedData& data, std::span<double> q,
                          const ClosureOptions& options = {});

// Projects v onto J v = 0, to the nearest velocities in the kinetic-energy metric. This is the
// effect of an impact of the constraints on v.
Expected<void> project_velocities(const Model& model, ConstrainedData& data,
                                  std::span<const double> q, std::span<double> v);

}  // namespace vp
