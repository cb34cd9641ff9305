// G x = r for a symmetric positive semidefinite G whose rows may depend on each other.
//
//   S G S = P^T L L^T P,   S = diag(1 / sqrt(G_ii)),   the largest diagonal entry first
//
// A remaining entry of the diagonal is then the squared sine of the angle between its row and those
// before it, a number without a unit: rows below kDependent are left out, with x = 0. So redundant
// rows do no harm; whether they contradict the others is seen from what G x - r leaves in them.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

namespace vp::detail {

// Rounding leaves some 1e-15 in a row that depends on others, and a loop closed to 1e-8 makes sines
// of 1e-8 between rows that coincide when it is closed exactly, 1e-16 squared. Larger: a mechanism
// is taken for singular farther from its singular position, here 3e-6 rad.
inline constexpr double kDependent = 1e-11;

class PivotedCholesky {
 public:
  explicit PivotedCholesky(std::size_t capacity);

  // G is size x size, its rows `stride` apart. A row whose diagonal is at most its floor counts as
  // zero and is left out. Returns the rank.
  std::size_t factor(std::span<const double> G, std::size_t size, std::size_t stride,
                     std::span<const double> floor);
  // x <- a solution, zero in the rows that are left out.
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
