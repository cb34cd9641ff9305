// Solves for the impulses p of several joints, each with its own force law (force_law.h):
//
//   w = w_free + G p,   (w_i, p_i) on law i,   G symmetric positive semidefinite
//
// The solution minimises a convex function, so w is unique. Newton's method replaces each law by
// its current linear piece and solves one linear system. If the pieces do not change, this solution
// is exact to rounding. If Newton's step fails, a line search and Gauss-Seidel sweeps over the
// joints follow, which always converge.
#pragma once

#include <span>
#include <vector>

#include "multibody/force_law.h"
#include "multibody/pivoted_cholesky.h"

namespace vp::detail {

struct ForceLawSolver {
  explicit ForceLawSolver(std::size_t capacity);

  // The problem: `size` joints; the row stride of G is `capacity`. self is the diagonal of G before
  // the elimination of constraints, which distinguishes a diagonal entry from rounding.
  std::size_t capacity, size = 0;
  std::vector<double> G, w_free, self;
  std::vector<ForceLaw> force_laws;
  // The solution, and each joint's point on its law. A good initial p speeds up convergence.
  std::vector<double> p, w;
  std::vector<ForceLawPoint> on;

  // Returns the number of iterations. off() is then the largest residual of a law, relative to the
  // terms in its velocity.
  int solve();
  double off() const { return off_; }

 private:
  void find_w();
  double update_active_pieces(double caution);
  void newton();
  void line_search();
  void sweep();

  double off_ = 0.0;
  std::vector<double> D_, scale_, best_, direction_, bend_, A_, rhs_, floor_;
  std::vector<std::size_t> active_;
  PivotedCholesky cholesky_;
};

}  // namespace vp::detail
