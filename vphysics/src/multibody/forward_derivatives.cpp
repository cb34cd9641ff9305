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
// solve for all columns at once, along contiguous rows. On the way inwards the rows of dtau/dq keep
// the zeros of M: nothing but the range from the root to the last velocity that i moves is touched.
// M^-1 is symmetric, so only what is right of the diagonal is computed.
#include <algorithm>

#include "multibody/derivatives.h"
#include "vphysics/assert.h"

namespace vp {
namespace detail {
namespace {

// L and 1/D, in place of M. False where M is not positive definite.
template <class T>
bool factor_by_rows(DerivativesWork<T>& memory) {
  const std::size_t n = memory.branches.size();
  const auto before = [&](std::size_t i) { return memory.branches[i].parent; };
  for (std::size_t k = n; k-- > 0;) {
    T* row = &memory.L[k * n];
    if (!(row[k] > T(0))) return false;
    memory.D_inverse[k] = T(1) / row[k];
    for (int i = before(k); i >= 0; i = before(static_cast<std::size_t>(i))) {
      const auto at = static_cast<std::size_t>(i);
      const T share = row[at] * memory.D_inverse[k];
      T* other = &memory.L[at * n];
      for (int j = i; j >= 0; j = before(static_cast<std::size_t>(j))) {
        other[j] -= share * row[j];
      }
      row[at] = share;
    }
  }
  return true;
}

template <class T>
void subtract_row(T share, const T* __restrict from, T* __restrict to, std::size_t begin,
                  std::size_t end) {
  for (std::size_t c = begin; c < end; ++c) to[c] -= share * from[c];
}

// What of the rows the two sweeps touch.
struct Columns {
  std::size_t inwards_begin, inwards_end, outwards_begin, outwards_end;
};
Columns columns_of(const Branch& branch) {
  const auto first = static_cast<std::size_t>(branch.first);
  return {first, static_cast<std::size_t>(branch.end), first,
          static_cast<std::size_t>(branch.tree_end)};
}
Columns columns_right_of(const Branch& branch, std::size_t i) {
  return {i, static_cast<std::size_t>(branch.end), i, static_cast<std::size_t>(branch.tree_end)};
}

template <class T, class Range>
void sweep_inwards(const DerivativesWork<T>& memory, std::span<T> X, const Range& range) {
  const std::size_t n = memory.branches.size();
  for (std::size_t i = n; i-- > 0;) {
    const Columns columns = range(i);
    for (int j = memory.branches[i].parent; j >= 0;
         j = memory.branches[static_cast<std::size_t>(j)].parent) {
      const auto at = static_cast<std::size_t>(j);
      subtract_row(memory.L[i * n + at], &X[i * n], &X[at * n], columns.inwards_begin,
                   columns.inwards_end);
    }
  }
}

template <class T, class Range>
void sweep_outwards(const DerivativesWork<T>& memory, std::span<T> X, T sign, const Range& range) {
  const std::size_t n = memory.branches.size();
  for (std::size_t i = 0; i < n; ++i) {
    const Columns columns = range(i);
    T* row = &X[i * n];
    const T scale = sign * memory.D_inverse[i];
    for (std::size_t c = columns.outwards_begin; c < columns.outwards_end; ++c) row[c] *= scale;
    for (int j = memory.branches[i].parent; j >= 0;
         j = memory.branches[static_cast<std::size_t>(j)].parent) {
      const auto at = static_cast<std::size_t>(j);
      subtract_row(memory.L[i * n + at], &X[at * n], row, columns.outwards_begin,
                   columns.outwards_end);
    }
  }
}

// X <- -M^-1 X, of a matrix with the zeros of M.
template <class T>
void solve(const DerivativesWork<T>& memory, std::span<T> X) {
  const auto range = [&](std::size_t i) { return columns_of(memory.branches[i]); };
  sweep_inwards(memory, X, range);
  sweep_outwards(memory, X, T(-1), range);
}

// X <- M^-1
template <class T>
void invert(const DerivativesWork<T>& memory, std::span<T> X) {
  const std::size_t n = memory.branches.size();
  std::fill(X.begin(), X.end(), T(0));
  for (std::size_t i = 0; i < n; ++i) X[i * n + i] = T(1);
  const auto range = [&](std::size_t i) { return columns_right_of(memory.branches[i], i); };
  sweep_inwards(memory, X, range);
  sweep_outwards(memory, X, T(1), range);
  for (std::size_t i = 0; i < n; ++i) {
    for (std::size_t c = 0; c < i; ++c) X[i * n + c] = X[c * n + i];
  }
}

}  // namespace
}  // namespace detail

template <class T>
Expected<void> forward_dynamics_derivatives(const ModelT<T>& model, DataT<T>& data,
                                            DerivativesDataT<T>& memory, std::span<const T> q,
                                            std::span<const T> v, std::span<const T> tau,
                                            const LoadsT<T>& loads,
                                            const ForwardDerivativesT<T>& out) {
  VP_ASSERT(q.size() == static_cast<std::size_t>(model.coordinates()));
  VP_ASSERT(v.size() == static_cast<std::size_t>(model.velocities()) && tau.size() == v.size());
  VP_ASSERT(out.a.size() == v.size() && detail::is_square(out.a_q, v.size()) &&
            detail::is_square(out.a_v, v.size()) && detail::is_square(out.a_tau, v.size()));
  const auto solved = forward_dynamics<T>(model, data, q, v, tau, loads, out.a);
  if (!solved) return solved;
  detail::DerivativesWork<T>& work = memory.work();
  const auto differentiated = detail::differentiate<T>(
      "forward_dynamics_derivatives", model.tree(), data.work(), work, q, v, out.a, loads,
      {.tau_q = out.a_q, .tau_v = out.a_v, .tau_a = work.L});
  if (!differentiated) return differentiated;
  if (!detail::factor_by_rows(work)) {
    return tl::make_unexpected(
        Error{Errc::singular,
              "forward_dynamics_derivatives: the mass matrix is not positive definite in this "
              "configuration; give the links an inertia, or the joints an armature"});
  }
  detail::solve<T>(work, out.a_q);
  detail::solve<T>(work, out.a_v);
  detail::invert<T>(work, out.a_tau);
  return {};
}

#define VP_FORWARD_DERIVATIVES(T)                                                                \
  template Expected<void> forward_dynamics_derivatives(                                          \
      const ModelT<T>&, DataT<T>&, DerivativesDataT<T>&, std::span<const T>, std::span<const T>, \
      std::span<const T>, const LoadsT<T>&, const ForwardDerivativesT<T>&);
VP_FORWARD_DERIVATIVES(double)
VP_FORWARD_DERIVATIVES(float)

}  // namespace vp
