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
  std::vector<int> coordinate;  // of each velocity: the coordinate that it is the rate of, or -1

  std::vector<double> phi, J, bias, magnitude, lambda;  // of the constraints
  std::vector<se3> link_bias;                           // of each node, in its tree's frame
  // Rows in use: the constraints' and then, each a unit row, some velocities'.
  std::vector<std::size_t> joints;  // which velocities
  std::vector<double> Y;            // M^-1 J^T, row by row
  std::vector<double> G;            // J M^-1 J^T, its rows `capacity` apart
  std::vector<double> floor;        // of G's diagonal, below which a row is zero
  PivotedCholesky cholesky;
  std::vector<double> rhs, left, terms, step, q_trial, v_zero;
  // Of constrained_step: the joints' laws, and for each velocity the impulse that its law had last.
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
  // The i-th row in use times x.
  double along(std::size_t i, std::span<const double> x) const;
};

// phi, J and b; forward_kinematics has been called with q and v.
void evaluate_rows(const Model& model, ConstraintWork& work, std::span<const double> q,
                   std::span<const double> v);
// Y, G and floor of the rows in use; M is in factors.
void respond(const Model& model, ConstraintWork& work);
// Solves G p = rhs for the rows in use, once refined; left is then what is left of each row.
void solve_rows(ConstraintWork& work, std::span<double> p);
// Whether the rows that depend on others contradict them, by left beside terms.
bool contradicted(const ConstraintWork& work);
tl::unexpected<Error> contradiction(const char* call);
// x += Y^T p
void add_response(const ConstraintWork& work, std::span<const double> p, std::span<double> x);

// close_loops, with work.joints held where they are.
Expected<int> close(const Model& model, ConstraintWork& work, std::span<double> q, double tolerance,
                    int max_steps);

}  // namespace vp::detail
