// The memory of the derivatives and the public calls; the passes are in differentiate.h and
// solve_rows.h.
#include "multibody/derivatives.h"

#include <algorithm>
#include <string>

#include "multibody/derivative_kernels.h"
#include "multibody/instruction_set.h"
#include "vphysics/assert.h"

namespace vp {
namespace detail {
namespace {

template <class T>
void lay_out_branches(const Tree<T>& tree, DerivativesWork<T>& memory) {
  for (std::size_t i = 0; i < tree.nodes.size(); ++i) {
    const Node<T>& node = tree.nodes[i];
    for (int k = 0; k < node.dofs; ++k) {
      Branch& branch = memory.branches[static_cast<std::size_t>(node.v + k)];
      branch.parent = node.v + k - 1;
      if (k == 0 && node.parent == kWorld) branch.parent = -1;
      if (k == 0 && node.parent != kWorld) {
        const Node<T>& before = tree.nodes[static_cast<std::size_t>(node.parent)];
        branch.parent = before.v + before.dofs - 1;
      }
    }
  }
  // A parent's velocities have lower numbers.
  for (std::size_t i = 0; i < memory.branches.size(); ++i) {
    Branch& branch = memory.branches[i];
    const int own = static_cast<int>(i);
    branch.first_run = static_cast<int>(memory.runs.size());
    branch.first = own;
    branch.end = own + 1;
    if (branch.parent >= 0) {
      const Branch before = memory.branches[static_cast<std::size_t>(branch.parent)];
      branch.first = before.first;
      for (int r = before.first_run; r < before.end_run; ++r) {
        memory.runs.push_back(memory.runs[static_cast<std::size_t>(r)]);
      }
    }
    if (branch.parent >= 0 && memory.runs.back().end == own) {
      ++memory.runs.back().end;
    } else {
      memory.runs.push_back({own, own + 1});
    }
    branch.end_run = static_cast<int>(memory.runs.size());
    for (int j = branch.parent; j >= 0; j = memory.branches[static_cast<std::size_t>(j)].parent) {
      memory.branches[static_cast<std::size_t>(j)].end = own + 1;
    }
  }
  for (Branch& branch : memory.branches) {
    branch.tree_end = memory.branches[static_cast<std::size_t>(branch.first)].end;
  }
}

template <class T>
const vphysics_kernels::DerivativeKernels& derivative_kernels_of(const DataT<T>& data) {
  constexpr std::size_t kScalar = std::is_same_v<T, double> ? 0 : 1;
  switch (data.work().instruction_set) {
#ifdef VP_INSTRUCTION_SETS
    case InstructionSet::avx512:
      return vphysics_kernels::kAvx512Derivatives[kScalar];
    case InstructionSet::avx2:
      return vphysics_kernels::kAvx2Derivatives[kScalar];
#endif
    default:
      return vphysics_kernels::kBaselineDerivatives[kScalar];
  }
}

template <class T>
Expected<void> differentiate(const char* call, const ModelT<T>& model, const DataT<T>& data,
                             DerivativesWork<T>& memory, Span<T> q, Span<T> v, Span<T> a,
                             const LoadsT<T>& loads, const InverseMatrices<T>& out) {
  VP_ASSERT(loads.external.empty() ||
            loads.external.size() == static_cast<std::size_t>(model.links()));
  if (derivative_kernels_of(data).differentiate(
          {&model.tree(), &data.work(), &memory, q.data(), v.data(), a.data(), &loads, &out})) {
    return {};
  }
  return tl::make_unexpected(
      Error{Errc::unsupported, std::string(call) +
                                   ": a joint of one's own does not say its slopes; override "
                                   "UserJoint::slopes in it"});
}

}  // namespace

template <class T>
DerivativesWork<T>::DerivativesWork(const Tree<T>& tree)
    : branches(static_cast<std::size_t>(tree.velocities)),
      A(tree.nodes.size()),
      composites(tree.nodes.size()),
      S(branches.size()),
      S1(branches.size()),
      S2(branches.size()),
      Sv(branches.size()),
      L(branches.size()),
      L_transposed(branches.size()),
      Q(branches.size()),
      V(branches.size()),
      inverse(branches.size()),
      D_inverse(branches.size()) {
  for (auto& numbers : along)
    numbers = AlignedArray<T>(padded<T>(branches.size() + kWidestPack<T>));
  for (const Node<T>& node : tree.nodes) {
    const bool user = node.kind == NodeKind::user;
    slopes_of.push_back(user ? static_cast<int>(slopes.size()) : -1);
    if (user) slopes.emplace_back();
  }
  lay_out_branches(tree, *this);
}

}  // namespace detail

template <class T>
DerivativesDataT<T>::DerivativesDataT(const ModelT<T>& model)
    : work_(std::make_unique<detail::DerivativesWork<T>>(model.tree())) {}
template <class T>
DerivativesDataT<T>::~DerivativesDataT() = default;
template <class T>
DerivativesDataT<T>::DerivativesDataT(DerivativesDataT&&) noexcept = default;
template <class T>
DerivativesDataT<T>& DerivativesDataT<T>::operator=(DerivativesDataT&&) noexcept = default;

template <class T>
Expected<void> inverse_dynamics_derivatives(const ModelT<T>& model, DataT<T>& data,
                                            DerivativesDataT<T>& memory, std::span<const T> q,
                                            std::span<const T> v, std::span<const T> a,
                                            const LoadsT<T>& loads,
                                            const InverseDerivativesT<T>& out) {
  VP_ASSERT(q.size() == static_cast<std::size_t>(model.coordinates()));
  VP_ASSERT(v.size() == static_cast<std::size_t>(model.velocities()) && a.size() == v.size());
  VP_ASSERT(detail::is_square(out.tau_q, v.size()) && detail::is_square(out.tau_v, v.size()) &&
            detail::is_square(out.tau_a, v.size()));
  forward_kinematics<T>(model, data, q, v);
  for (const auto& matrix : {out.tau_q, out.tau_v, out.tau_a}) {
    std::fill(matrix.begin(), matrix.end(), T(0));
  }
  const std::size_t n = v.size();
  return detail::differentiate<T>(
      "inverse_dynamics_derivatives", model, data, memory.work(), q, v, a, loads,
      {{out.tau_q.data(), n}, {out.tau_v.data(), n}, {out.tau_a.data(), n}});
}

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
  // L has its zeros where M has them, in every configuration; X does not keep them.
  work.Q.clear();
  work.V.clear();
  const auto differentiated =
      detail::differentiate<T>("forward_dynamics_derivatives", model, data, work, q, v, out.a,
                               loads, {work.Q, work.V, work.L});
  if (!differentiated) return differentiated;
  if (!detail::derivative_kernels_of(data).solve(
          {&work, v.size(), out.a_q.data(), out.a_v.data(), out.a_tau.data()})) {
    return tl::make_unexpected(
        Error{Errc::singular,
              "forward_dynamics_derivatives: the mass matrix is not positive definite in this "
              "configuration; give the links an inertia, or the joints an armature"});
  }
  return {};
}

#define VP_DERIVATIVES(T)                                                                        \
  template struct detail::DerivativesWork<T>;                                                    \
  template class DerivativesDataT<T>;                                                            \
  template Expected<void> inverse_dynamics_derivatives(                                          \
      const ModelT<T>&, DataT<T>&, DerivativesDataT<T>&, std::span<const T>, std::span<const T>, \
      std::span<const T>, const LoadsT<T>&, const InverseDerivativesT<T>&);                      \
  template Expected<void> forward_dynamics_derivatives(                                          \
      const ModelT<T>&, DataT<T>&, DerivativesDataT<T>&, std::span<const T>, std::span<const T>, \
      std::span<const T>, const LoadsT<T>&, const ForwardDerivativesT<T>&);
VP_DERIVATIVES(double)
VP_DERIVATIVES(float)

}  // namespace vp
