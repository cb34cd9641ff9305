// Derivatives of forward dynamics. From tau(q, v, a(q, v, tau)) = tau:
//
//   da/dtau = M^-1,   da/dq = -M^-1 dtau/dq,   da/dv = -M^-1 dtau/dv
//
// M = L^T D L, L of unit diagonal and with entries only from a velocity to those before it on the
// way to the root, as M has (Featherstone, Rigid Body Dynamics Algorithms, 2008, section 6.5). So
//
//   inwards    row j -= L_ij row i   for each j before i
//   outwards   row i = row i / D_i - sum over j of L_ij row j
//
// solve for all columns at once, along contiguous rows: a row takes up all that is subtracted from
// it while a few packs of its numbers are in registers. On the way inwards the rows of dtau/dq keep
// the zeros of M, so that nothing but the range from the root to the last velocity that j moves is
// touched; M^-1 is symmetric, so nothing left of the diagonal is computed, but for what a whole
// pack takes along and nobody reads.
#pragma once

#include <algorithm>

#include "multibody/derivatives.h"

namespace vp::detail::slopes {

// Of a row, the numbers that are touched: as many for every instruction set, so that even the signs
// of zeros are the same.
template <class T>
struct Columns {
  std::size_t begin, end;
  Columns(std::size_t first, std::size_t last)
      : begin(first / kWidestPack<T> * kWidestPack<T>), end(padded<T>(last)) {}
};

// to -= share * from
template <class T>
void subtract_row(T share, const T* from, T* to, const Columns<T>& columns) {
  const Lanes<T> k(share);
  for (std::size_t c = columns.begin; c < columns.end; c += kPack<T>) {
    store_lanes(to + c, load_lanes(to + c) - k * load_lanes(from + c));
  }
}

// L and 1/D, in place of M. On the diagonal of L, where ones would be, is zero; what is right of it
// is lost. False where M is not positive definite.
template <class T>
bool factor_by_rows(DerivativesWork<T>& memory) {
  const MatrixView<T> L = memory.L, transposed = memory.L_transposed;
  const auto before = [&](std::size_t i) { return memory.branches[i].parent; };
  for (std::size_t k = memory.branches.size(); k-- > 0;) {
    T* row = L.row(k);
    if (!(row[k] > T(0))) return false;
    memory.D_inverse[k] = T(1) / row[k];
    const auto first = static_cast<std::size_t>(memory.branches[k].first);
    for (int at = before(k); at >= 0; at = before(static_cast<std::size_t>(at))) {
      const auto i = static_cast<std::size_t>(at);
      const T share = row[i] * memory.D_inverse[k];
      // Before i, row k is zero but for those before i on the way to the root.
      subtract_row(share, row, L.row(i), {first, i + 1});
      row[i] = share;
      transposed(i, k) = share;
    }
    row[k] = T(0);
  }
  return true;
}

// Row `to` of X: scale times itself less factors[i] times row i for those in a run; N packs from
// column c.
template <class T, std::size_t N>
void take_up(const MatrixView<T>& X, std::size_t to, std::size_t c, T scale, const T* factors,
             std::span<const Run> runs) {
  std::array<Lanes<T>, N> sum;
  for (std::size_t p = 0; p < N; ++p) {
    sum[p] = Lanes<T>(scale) * load_lanes(X.row(to) + c + p * kPack<T>);
  }
  for (const Run& run : runs) {
    for (auto i = static_cast<std::size_t>(run.first); i < static_cast<std::size_t>(run.end); ++i) {
      const Lanes<T> factor(factors[i]);
      const T* from = X.row(i) + c;
      for (std::size_t p = 0; p < N; ++p) {
        sum[p] -= factor * load_lanes(from + p * kPack<T>);
      }
    }
  }
  for (std::size_t p = 0; p < N; ++p) store_lanes(X.row(to) + c + p * kPack<T>, sum[p]);
}
template <class T>
void take_up(const MatrixView<T>& X, std::size_t to, const Columns<T>& columns, T scale,
             const T* factors, std::span<const Run> runs) {
  std::size_t c = columns.begin;
  for (; c + 6 * kPack<T> <= columns.end; c += 6 * kPack<T>) {
    take_up<T, 6>(X, to, c, scale, factors, runs);
  }
  for (; c + 2 * kPack<T> <= columns.end; c += 2 * kPack<T>) {
    take_up<T, 2>(X, to, c, scale, factors, runs);
  }
  for (; c < columns.end; c += kPack<T>) take_up<T, 1>(X, to, c, scale, factors, runs);
}

// X <- sign M^-1 X. The columns of row i begin at first(i).
template <class T, class First>
void solve(DerivativesWork<T>& memory, const MatrixView<T>& X, T sign, const First& first) {
  const MatrixView<T> L = memory.L, transposed = memory.L_transposed;
  for (std::size_t j = memory.branches.size(); j-- > 0;) {
    const Branch& branch = memory.branches[j];
    const Run after{static_cast<int>(j) + 1, branch.end};
    take_up<T>(X, j, {first(j), static_cast<std::size_t>(branch.end)}, T(1), transposed.row(j),
               std::span(&after, 1));
  }
  for (std::size_t i = 0; i < memory.branches.size(); ++i) {
    const Branch& branch = memory.branches[i];
    take_up<T>(X, i, {first(i), static_cast<std::size_t>(branch.tree_end)},
               sign * memory.D_inverse[i], L.row(i), memory.way(branch));
  }
}

template <class T>
void copy_out(std::size_t n, const MatrixView<T>& X, std::span<T> out) {
  for (std::size_t i = 0; i < n; ++i) {
    std::copy(X.row(i), X.row(i) + n, out.begin() + static_cast<std::ptrdiff_t>(i * n));
  }
}

// out <- -M^-1 X, of a matrix with the zeros of M.
template <class T>
void solve(DerivativesWork<T>& memory, const MatrixView<T>& X, std::span<T> out) {
  solve(memory, X, T(-1),
        [&](std::size_t i) { return static_cast<std::size_t>(memory.branches[i].first); });
  copy_out(memory.branches.size(), X, out);
}

// out <- M^-1
template <class T>
void invert(DerivativesWork<T>& memory, std::span<T> out) {
  const std::size_t n = memory.branches.size();
  const MatrixView<T> X = memory.inverse;
  memory.inverse.clear();
  for (std::size_t i = 0; i < n; ++i) X(i, i) = T(1);
  solve(memory, X, T(1), [](std::size_t i) { return i; });
  for (std::size_t i = 0; i < n; ++i) {
    for (std::size_t c = i; c < n; ++c) out[i * n + c] = out[c * n + i] = X(i, c);
  }
}

// From dtau/dq, dtau/dv and M, where `differentiate_kernel` has put them. False where M is not
// positive definite.
template <class T>
bool solve_kernel(DerivativesWork<T>& memory, std::span<T> a_q, std::span<T> a_v,
                  std::span<T> a_tau) {
  if (!factor_by_rows(memory)) return false;
  solve<T>(memory, memory.Q, a_q);
  solve<T>(memory, memory.V, a_v);
  invert<T>(memory, a_tau);
  return true;
}

}  // namespace vp::detail::slopes
