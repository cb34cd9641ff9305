#include "multibody/pivoted_cholesky.h"

#include <algorithm>
#include <cmath>

namespace vp::detail {

PivotedCholesky::PivotedCholesky(std::size_t capacity)
    : max_(capacity),
      L_(capacity * capacity),
      scale_(capacity),
      diagonal_(capacity),
      work_(capacity),
      order_(capacity) {}

// Exchanges two rows of the partial L, and their entries in the order.
void PivotedCholesky::bring_forward(std::size_t k, std::size_t pivot) {
  if (k == pivot) return;
  std::swap(order_[k], order_[pivot]);
  std::swap(diagonal_[k], diagonal_[pivot]);
  for (std::size_t j = 0; j < k; ++j) std::swap(L(k, j), L(pivot, j));
}

std::size_t PivotedCholesky::factor(std::span<const double> G, std::size_t size, std::size_t stride,
                                    std::span<const double> floor) {
  size_ = size;
  for (std::size_t i = 0; i < size; ++i) {
    const double g = G[i * stride + i];
    scale_[i] = g > floor[i] ? 1.0 / std::sqrt(g) : 0.0;
    diagonal_[i] = scale_[i] > 0.0 ? 1.0 : 0.0;
    order_[i] = i;
  }
  for (rank_ = 0; rank_ < size; ++rank_) {
    const std::size_t k = rank_;
    const auto begin = diagonal_.begin() + static_cast<std::ptrdiff_t>(k);
    const auto end = diagonal_.begin() + static_cast<std::ptrdiff_t>(size);
    const auto largest = std::max_element(begin, end);
    if (!(*largest > kDependent)) break;
    bring_forward(k, static_cast<std::size_t>(largest - diagonal_.begin()));
    L(k, k) = std::sqrt(diagonal_[k]);
    const double inverse = 1.0 / L(k, k);
    for (std::size_t i = k + 1; i < size; ++i) {
      double sum = G[order_[i] * stride + order_[k]] * scale_[order_[i]] * scale_[order_[k]];
      for (std::size_t j = 0; j < k; ++j) sum -= L(i, j) * L(k, j);
      L(i, k) = sum * inverse;
      diagonal_[i] -= L(i, k) * L(i, k);
    }
  }
  return rank_;
}

void PivotedCholesky::solve(std::span<double> x) {
  for (std::size_t k = 0; k < rank_; ++k) {
    double sum = x[order_[k]] * scale_[order_[k]];
    for (std::size_t j = 0; j < k; ++j) sum -= L(k, j) * work_[j];
    work_[k] = sum / L(k, k);
  }
  for (std::size_t k = rank_; k-- > 0;) {
    double sum = work_[k];
    for (std::size_t i = k + 1; i < rank_; ++i) sum -= L(i, k) * work_[i];
    work_[k] = sum / L(k, k);
  }
  for (std::size_t k = 0; k < size_; ++k) {
    x[order_[k]] = k < rank_ ? work_[k] * scale_[order_[k]] : 0.0;
  }
}

}  // namespace vp::detail
