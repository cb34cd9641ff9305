// Impulses p of several joints, each under its own law (force_law.h), with
//
//   w = w_free + G p,   (w_i, p_i) on law i,   G symmetric positive semidefinite
//
// It is the minimum of a convex function, so that one w solves it. Newton: with each law replaced
// by the straight piece that it is on, one set of linear equations; where the pieces stay, that is
// the answer, exact to rounding. Where Newton's step makes it worse, sweeps joint by joint
// (Gauss-Seidel), which always converge.
#pragma once

#include <span>
#include <vector>

#include "multibody/force_law.h"
#include "multibody/pivoted_cholesky.h"

namespace vp::detail {

struct ForceLawSolver {
  explicit ForceLawSolver(std::size_t capacity);

  // What is to be solved: size joints; G's rows are `most` apart. Each self is the diagonal of G
  // before constraints took their share, which tells a diagonal from rounding.
  std::size_t capacity, size = 0;
  std::vector<double> G, w_free, self;
  std::vector<ForceLaw> force_laws;
  // The answer, and where each is on its law; a good guess of p makes it quick.
  std::vector<double> p, w;
  std::vector<ForceLawPoint> on;

  // How many rounds it took; off() then says how far the worst law is missed, relative to the terms
  // in its velocity.
  int solve();
  double off() const { return off_; }

 private:
  void find_w();
  double find_pieces(double caution);
  void newton();
  void go_towards_newton();
  void sweep();

  double off_ = 0.0;
  std::vector<double> D_, scale_, best_, direction_, bend_, A_, rhs_, floor_;
  std::vector<std::size_t> active_;
  PivotedCholesky cholesky_;
};

}  // namespace vp::detail
