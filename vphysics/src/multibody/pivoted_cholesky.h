// Solves G x = r for a symmetric positive semidefinite G with possibly dependent rows.
//
//   S G S = P^T L L^T P,   S = diag(1 / sqrt(G_ii)),   the largest diagonal entry first
//
// A remaining diagonal entry is the squared sine of the angle between its row and the earlier rows,
// which has no unit. Rows below kDependent are omitted, with x = 0. Redundant rows are therefore
// harmless; the residual G x - r in them shows whether they contradict the others.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

namespace vp::detail {

// Rounding leaves about 1e-15 in a dependent row. In a loop closed to 1e-8, rows that coincide in
// the closed loop have sines of 1e-8, 1e-16 squared. A larger value would treat a mechanism as
// singular farther from its singular configuration; here within 3e-6 rad.
inline constexpr double kDependent = 1e-11;

class PivotedCholesky {
 public:
  explicit PivotedCholesky(std::size_t capacity);

  // G is size x size with row stride `stride`. A row whose diagonal is at most its floor counts as
  // zero and is omitted. Returns the rank.
  std::size_t factor(std::span<const double> G, std::size_t size, std::size_t stride,
                     std::span<const double> floor);
  // x <- a solution, zero in the omitted rows.
  void solve(std::span<double> x);
  std::size_t rank() const { return rank_; }

 private:
  double& L(std::size_t i, std::size_t j) { return L_[i * max_ + j]; }
  void bring_forward(std::size_t k, std::size_t pivot);

  std::size_t max_, size_ = 0, rank_ = 0;
  std::vector<double> L_;  // the lower triangle, row by row
  std::vector<double> scale_, diagonal_, work_;
  std::vector<std::size_t> order_;  // order_[k]: the row that is the k-th pivot
};

}  // namespace vp::detail
