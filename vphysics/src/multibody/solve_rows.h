// Derivatives of forward dynamics. From tau(q, v, a(q, v, tau)) = tau:
//
//   da/dtau = M^-1,   da/dq = -M^-1 dtau/dq,   da/dv = -M^-1 dtau/dv
//
// M = L^T D L. L has a unit diagonal and the sparsity of M: entries only from a velocity to the
// velocities before it on the path to the root (Featherstone, Rigid Body Dynamics Algorithms, 2008,
// section 6.5). The articulated body algorithm already computes L and D. It eliminates the
// velocities in the same order: its update of the articulated inertias, J^ -= J^ S_i (x) J^ S_i /
// Omega_i, projected on S_j and S_k of velocities before i, is the elimination's update of M_jk. In
// one frame
//
//   D_i = Omega_i,   L_ij = <S_j, W_i>,   W_i = J^_i S_i / Omega_i
//
// Only a free root is factored in the axes of the tree, for other S (factor_root). Therefore
//
//   tip to base   row j -= L_ij row i   for each j before i
//   base to tip   row i = row i / D_i - sum over j of L_ij row j
//
// solve for all columns, a few registers of columns at a time: a row's sum stays in registers, and
// the rows of these columns stay in the first-level cache. In the tip-to-base pass the rows of
// dtau/dq keep the zeros of M, so columns that no velocity on a row's path moves are skipped. M^-1
// is symmetric, so nothing left of the diagonal is computed, except to fill a register.
#pragma once

#include <algorithm>

#include "multibody/derivatives.h"

namespace vp::detail::derivatives {

// A range of a row, rounded to whole units of padding. It is the same for every instruction set, so
// that even the signs of zeros agree.
template <class T>
struct RowRange {
  std::size_t begin, end;
  RowRange(std::size_t first, std::size_t last)
      : begin(first / RowLanes<T>::kPadding * RowLanes<T>::kPadding), end(padded<T>(last)) {}
  bool meets(std::size_t first, std::size_t last) const { return begin < last && first < end; }
};

template <class T>
Lanes<T> load_row(const T* from) {
  if constexpr (kPack<T> == 1) {
    return *from;
  } else {
    return load<Lanes<T>>(from);
  }
}

// Computes the rows of L and 1/D of a free root in its own axes, from the factors of its
// articulated inertia in the tree's axes, J^ = sum over k of Omega_k W_k (x) W_k. Returns false if
// it is not positive definite.
template <class T>
bool factor_root(DerivativesWork<T>& memory, const Work<T>& work, const Node<base_t<T>>& node) {
  const auto first = static_cast<std::size_t>(node.v), dofs = static_cast<std::size_t>(node.dofs);
  const auto S = [&](std::size_t k) {
    return memory.velocity(node.v + static_cast<int>(k)).twist(kColumnS);
  };
  T A[6][6], omega[6];
  for (std::size_t k = 0; k < dofs; ++k) omega[k] = T(1) / work.factors[first + k].inverse;
  for (std::size_t i = 0; i < dofs; ++i) {
    const se3T<T> S_i = S(i);
    dse3T<T> JS{};
    for (std::size_t k = 0; k < dofs; ++k) {
      const dse3T<T>& W = work.factors[first + k].W;
      JS = JS + (omega[k] * (S_i * W)) * W;
    }
    for (std::size_t j = 0; j <= i; ++j) A[i][j] = S(j) * JS;
  }
  for (std::size_t k = dofs; k-- > 0;) {
    if (!all(A[k][k] > T(0))) return false;
    const T inverse = T(1) / A[k][k];
    memory.D_inverse[first + k] = inverse;
    for (std::size_t i = 0; i < k; ++i) {
      const T fraction = A[k][i] * inverse;
      memory.L(first + k, first + i) = fraction;
      for (std::size_t j = 0; j <= i; ++j) A[i][j] = A[i][j] - fraction * A[k][j];
    }
  }
  return true;
}

// Accumulates multiples of other rows in a few registers of a row.
template <class T, int kSums>
struct RowSums {
  // Raw compiler vectors, left uninitialised: initialising packs would write zeros to memory first.
  typename Lanes<T>::Lanes at[kSums];

  RowSums(const T* row, const T& scale) {
    for (int p = 0; p < kSums; ++p) {
      at[p] = (Lanes<T>(scale) * load_row(row + p * kPack<T>)).lanes;
    }
  }
  void subtract(const T& factor, const T* row) {
    const Lanes<T> k(factor);
    for (int p = 0; p < kSums; ++p) {
      at[p] = (Lanes<T>(at[p]) - k * load_row(row + p * kPack<T>)).lanes;
    }
  }
  void put(T* row) const {
    for (int p = 0; p < kSums; ++p) store(row + p * kPack<T>, Lanes<T>(at[p]));
  }
};

// X <- sign M^-1 X. shared > 0: X contains that many matrices with the zeros of M in shared rows.
// shared = 0: X is the identity, and the part of its solution on and right of the diagonal is
// computed.
template <class T>
class RowSolver {
 public:
  RowSolver(const DerivativesWork<T>& memory, T* X, std::size_t stride, std::size_t shared, T sign)
      : memory_(memory), X_(X), stride_(stride), shared_(shared), sign_(sign) {}

  void solve() const {
    const std::size_t registers = stride_ / kPack<T>;
    const std::size_t passes = (registers + kMaxSums - 1) / kMaxSums;
    const std::size_t size = (registers + passes - 1) / passes;
    for (std::size_t r = 0; r < registers; r += size) {
      solve_columns<kMaxSums>(static_cast<int>(std::min(size, registers - r)), r * kPack<T>);
    }
  }

 private:
  // Accumulators at once: eight registers, which leaves registers for a factor and a number of a
  // row, and whose rows stay in the first-level cache. For one state at most 32 numbers: more would
  // compute columns that a row does not have (measured: 6 % of the time of a humanoid).
  static constexpr int kRegistersEach =
      (static_cast<int>(sizeof(Lanes<T>)) + kRegister - 1) / kRegister;
  static constexpr int kAtBound = std::max(1, 8 / kRegistersEach);
  static constexpr int kMaxSums = kSlots<T> == 1 ? kAtBound : std::min(kAtBound, 256 / kRegister);

  // Solves the columns from c on.
  template <int kSums>
  void solve_columns(int sums, std::size_t c) const {
    if constexpr (kSums > 1) {
      if (sums < kSums) return solve_columns<kSums - 1>(sums, c);
    }
    const std::size_t end = c + static_cast<std::size_t>(kSums) * kPack<T>;
    const std::size_t n = memory_.branches.size();
    for (std::size_t j = n; j-- > 0;) {
      if (touched(j, memory_.branches[j].end).meets(c, end)) take_tip_to_base<kSums>(j, X_ + c);
    }
    for (std::size_t i = 0; i < n; ++i) {
      if (touched(i, memory_.branches[i].tree_end).meets(c, end))
        take_base_to_tip<kSums>(i, X_ + c);
    }
  }
  // Subtracts the rows that were finished most recently last.
  template <int kSums>
  VP_FLATTEN void take_tip_to_base(std::size_t j, T* X) const {
    RowSums<T, kSums> sums(X + j * stride_, T(1));
    const T* const L = memory_.factor.data() + j;
    for (auto i = static_cast<std::size_t>(memory_.branches[j].end); --i > j;) {
      sums.subtract(L[i * memory_.row_size], X + i * stride_);
    }
    sums.put(X + j * stride_);
  }
  template <int kSums>
  VP_FLATTEN void take_base_to_tip(std::size_t i, T* X) const {
    RowSums<T, kSums> sums(X + i * stride_, sign_ * memory_.D_inverse[i]);
    const T* const L = memory_.factor.data() + i * memory_.row_size;
    for (const Run& run : memory_.path_before(memory_.branches[i])) {
      const auto end = static_cast<std::size_t>(run.end);
      for (auto j = static_cast<std::size_t>(run.first); j < end; ++j) {
        sums.subtract(L[j], X + j * stride_);
      }
    }
    sums.put(X + i * stride_);
  }

  RowRange<T> touched(std::size_t row, int last) const {
    const auto end = static_cast<std::size_t>(last);
    if (shared_ == 0) return {row, end};
    constexpr auto kGroup = static_cast<std::size_t>(kSlots<T>);
    const auto first = static_cast<std::size_t>(memory_.branches[row].first);
    return {first / kGroup * kGroup * shared_, (end + kGroup - 1) / kGroup * kGroup * shared_};
  }

  const DerivativesWork<T>& memory_;
  T* X_;
  std::size_t stride_, shared_;
  T sign_;
};

// X <- -M^-1 X, for matrices with the zeros of M in shared rows.
template <class T>
void solve(const DerivativesWork<T>& memory, T* X, std::size_t stride, std::size_t matrices) {
  RowSolver<T>(memory, X, stride, matrices, T(-1)).solve();
}
// X <- M^-1 on and right of the diagonal. Precondition: X is zero.
template <class T>
void invert(const DerivativesWork<T>& memory, T* X, std::size_t stride) {
  for (std::size_t i = 0; i < memory.branches.size(); ++i) X[i * stride + i] = T(1);
  RowSolver<T>(memory, X, stride, 0, T(1)).solve();
}

// From dtau/dq, dtau/dv and L (except for free roots) as `differentiate` leaves them. Returns false
// if M is not positive definite.
template <class T>
bool factor_mass(const Tree<base_t<T>>& tree, const Work<T>& work, DerivativesWork<T>& memory) {
  for (std::size_t i = 0; i < memory.branches.size(); ++i) {
    memory.D_inverse[i] = work.factors[i].inverse;
  }
  for (const auto& node : tree.nodes) {
    if (node.free_root() && !factor_root(memory, work, node)) return false;
  }
  return true;
}

}  // namespace vp::detail::derivatives
