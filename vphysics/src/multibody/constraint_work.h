// Rows of constraints and of joints in one system, and M^-1 J^T, for the algorithms on them.
#pragma once

#include <vector>

#include "multibody/force_law_solver.h"
#include "multibody/pivoted_cholesky.h"
#include "vphysics/multibody/constrained_dynamics.h"

namespace vp::detail {

struct ConstraintWork {
  ConstraintWork(const Model& model, ConstraintSet constraints);

  std::size_t rows, velocities;
  ConstraintSet set;
  Data data;
  std::vector<int> coordinate;  // of each velocity: the coordinate whose rate it is, or -1

  std::vector<double> phi, J, bias, magnitude, lambda;  // of the constraints
  std::vector<se3> link_bias;                           // of each node, in its tree's frame
  // Active rows: the constraints' rows, then a unit row for each of some velocities.
  std::vector<std::size_t> joints;  // these velocities
  std::vector<double> Y;            // M^-1 J^T, row by row
  std::vector<double> G;            // J M^-1 J^T, row stride `capacity`
  std::vector<double> floor;        // of G's diagonal: a row below it counts as zero
  PivotedCholesky cholesky;
  std::vector<double> rhs, left, terms, step, q_trial, v_zero;
  // For constrained_step: the force laws of the joints, and for each velocity the last impulse of
  // its force law.
  ForceLawSolver force_laws;
  std::vector<double> warm, tau, q_before, force_law_force, motor_force;

  std::size_t capacity() const { return rows + velocities; }
  std::size_t in_use() const { return rows + joints.size(); }
  std::span<double> row_of_Y(std::size_t i) {
    return std::span(Y).subspan(i * velocities, velocities);
  }
  std::span<double> row_of_J(std::size_t i) {
    return std::span(J).subspan(i * velocities, velocities);
  }
  // The i-th active row times x.
  double along(std::size_t i, std::span<const double> x) const;
};

// Computes phi, J and b. Precondition: forward_kinematics was called with q and v.
void evaluate_rows(const Model& model, ConstraintWork& work, std::span<const double> q,
                   std::span<const double> v);
// Computes Y, G and floor of the active rows. Precondition: M is factored.
void respond(const Model& model, ConstraintWork& work);
// Solves G p = rhs for the active rows, with one step of iterative refinement. Leaves the residual
// of each row in left.
void solve_rows(ConstraintWork& work, std::span<double> p);
// Whether dependent rows contradict the others: compares left with terms.
bool contradicted(const ConstraintWork& work);
tl::unexpected<Error> contradiction(const char* call);
// x += Y^T p
void add_response(const ConstraintWork& work, std::span<const double> p, std::span<double> x);

// close_loops, with the coordinates of work.joints locked.
Expected<int> close(const Model& model, ConstraintWork& work, std::span<double> q, double tolerance,
                    int max_steps);

}  // namespace vp::detail
