// The working memory of the derivatives and the public calls. The passes are in differentiate.h and
// solve_rows.h.
#include "multibody/derivatives.h"

#include <algorithm>
#include <string>

#include "multibody/derivative_kernels.h"
#include "multibody/instantiate.h"
#include "multibody/instruction_set.h"
#include "vphysics/assert.h"

namespace vp {
namespace detail {
namespace {

using vphysics_kernels::DerivativeArguments;
using vphysics_kernels::Differentiated;

template <class T>
void lay_out_branches(const Tree<base_t<T>>& tree, DerivativesWork<T>& memory) {
  for (std::size_t i = 0; i < tree.nodes.size(); ++i) {
    const auto& node = tree.nodes[i];
    for (int k = 0; k < node.dofs; ++k) {
      Branch& branch = memory.branches[static_cast<std::size_t>(node.v + k)];
      branch.node = static_cast<int>(i);
      branch.column = k;
      branch.last = k + 1 == node.dofs;
      branch.parent = node.v + k - 1;
      if (k == 0 && node.parent == kWorld) branch.parent = -1;
      if (k == 0 && node.parent != kWorld) {
        const auto& before = tree.nodes[static_cast<std::size_t>(node.parent)];
        branch.parent = before.v + before.dofs - 1;
      }
    }
  }
  // Parents have lower indices.
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
  switch (data.work().instruction_set) {
#ifdef VP_INSTRUCTION_SETS
    case InstructionSet::avx512:
      return vphysics_kernels::kAvx512Derivatives[scalar_index<T>()];
    case InstructionSet::avx2:
      return vphysics_kernels::kAvx2Derivatives[scalar_index<T>()];
#endif
    default:
      return vphysics_kernels::kBaselineDerivatives[scalar_index<T>()];
  }
}

// The common arguments of both calls, without the accelerations and the results.
template <class T>
DerivativeArguments start(const ModelT<base_t<T>>& model, DataT<T>& data,
                          DerivativesDataT<T>& memory, Span<T> q, Span<T> v,
                          const LoadsT<T>& loads) {
  VP_ASSERT(memory.work().velocities() == v.size());
  VP_ASSERT(loads.external.empty() ||
            loads.external.size() == static_cast<std::size_t>(model.links()));
  DerivativeArguments args{};
  args.tree = &model.tree();
  args.work = &data.work();
  args.memory = &memory.work();
  args.q = q.data();
  args.v = v.data();
  args.gravity = &loads.gravity;
  args.external = loads.external.empty() ? nullptr : loads.external.data();
  return args;
}

Expected<void> report(const char* call, Differentiated how) {
  switch (how) {
    case Differentiated::done:
      return {};
    case Differentiated::no_derivatives:
      return tl::make_unexpected(Error{
          Errc::unsupported,
          std::string(call) + ": a user-defined joint has no derivatives of its subspace; override "
                              "UserJoint::subspace_derivatives in it"});
    case Differentiated::singular:
      break;
  }
  return tl::make_unexpected(
      Error{Errc::singular, std::string(call) +
                                ": the mass matrix is not positive definite in this "
                                "configuration; give the links an inertia, or the joints an "
                                "armature"});
}

}  // namespace

template <class T>
DerivativesWork<T>::DerivativesWork(const Tree<base_t<T>>& tree)
    : branches(static_cast<std::size_t>(tree.velocities)),
      A(tree.nodes.size()),
      records(static_cast<std::size_t>(groups() * kVelocityFields * kSlots<T>)),
      scratch(static_cast<std::size_t>(kScratchFields * kSlots<T>)),
      D_inverse(branches.size()),
      row_size(padded<T>(branches.size())),
      factor(branches.size() * row_size) {
  if constexpr (kSlots < T >> 1) {
    both = AlignedArray<T>(branches.size() * static_cast<std::size_t>(2 * groups() * kSlots<T>));
    inverse = AlignedArray<T>(branches.size() * row_size);
  }
  L = {factor.data(), row_size};
  for (const auto& node : tree.nodes) {
    const bool user = node.kind == NodeKind::user;
    derivatives_of.push_back(user ? static_cast<int>(derivatives.size()) : -1);
    if (user) derivatives.emplace_back();
  }
  lay_out_branches<T>(tree, *this);
}

}  // namespace detail

template <class T>
DerivativesDataT<T>::DerivativesDataT(const ModelT<base_t<T>>& model)
    : work_(std::make_unique<detail::DerivativesWork<T>>(model.tree())) {}
template <class T>
DerivativesDataT<T>::~DerivativesDataT() = default;
template <class T>
DerivativesDataT<T>::DerivativesDataT(DerivativesDataT&&) noexcept = default;
template <class T>
DerivativesDataT<T>& DerivativesDataT<T>::operator=(DerivativesDataT&&) noexcept = default;

template <class T>
Expected<void> inverse_dynamics_derivatives(const ModelT<base_t<T>>& model, DataT<T>& data,
                                            DerivativesDataT<T>& memory, std::span<const T> q,
                                            std::span<const T> v, std::span<const T> a,
                                            const LoadsT<T>& loads,
                                            const InverseDerivativesT<T>& out) {
  VP_ASSERT(q.size() == static_cast<std::size_t>(model.coordinates()));
  VP_ASSERT(v.size() == static_cast<std::size_t>(model.velocities()) && a.size() == v.size());
  VP_ASSERT(detail::is_square(out.tau_q, v.size()) && detail::is_square(out.tau_v, v.size()) &&
            detail::is_square(out.tau_a, v.size()));
  forward_kinematics<T>(model, data, q, v);
  auto args = detail::start<T>(model, data, memory, q, v, loads);
  args.a = a.data();
  args.by_q = out.tau_q.data();
  args.by_v = out.tau_v.data();
  args.by_force = out.tau_a.data();
  return detail::report("inverse_dynamics_derivatives",
                        detail::derivative_kernels_of(data).inverse(args));
}

template <class T>
Expected<void> forward_dynamics_derivatives(const ModelT<base_t<T>>& model, DataT<T>& data,
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
  auto args = detail::start<T>(model, data, memory, q, v, loads);
  args.a = out.a.data();
  args.by_q = out.a_q.data();
  args.by_v = out.a_v.data();
  args.by_force = out.a_tau.data();
  return detail::report("forward_dynamics_derivatives",
                        detail::derivative_kernels_of(data).forward(args));
}

#define VP_DERIVATIVES(T)                                                                       \
  template struct detail::DerivativesWork<T>;                                                   \
  template class DerivativesDataT<T>;                                                           \
  template Expected<void> inverse_dynamics_derivatives(                                         \
      const ModelT<base_t<T>>&, DataT<T>&, DerivativesDataT<T>&, std::span<const T>,            \
      std::span<const T>, std::span<const T>, const LoadsT<T>&, const InverseDerivativesT<T>&); \
  template Expected<void> forward_dynamics_derivatives(                                         \
      const ModelT<base_t<T>>&, DataT<T>&, DerivativesDataT<T>&, std::span<const T>,            \
      std::span<const T>, std::span<const T>, const LoadsT<T>&, const ForwardDerivativesT<T>&);
VP_FOR_EACH_SCALAR(VP_DERIVATIVES)

}  // namespace vp
