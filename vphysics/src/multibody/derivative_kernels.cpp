// One instruction set's passes of the derivatives. The build names the set as for kernels.cpp.
#include "multibody/derivative_kernels.h"

#include "multibody/differentiate.h"
#include "multibody/solve_rows.h"

namespace vp {
namespace detail {
namespace {

template <class T>
bool run_differentiate(const vphysics_kernels::DifferentiateArguments& args) {
  const auto& tree = *static_cast<const Tree<T>*>(args.tree);
  const auto numbers = [](const void* at, int count) {
    return Span<T>(static_cast<const T*>(at), static_cast<std::size_t>(count));
  };
  return slopes::differentiate_kernel<T>(
      tree, *static_cast<const Work<T>*>(args.work), *static_cast<DerivativesWork<T>*>(args.memory),
      numbers(args.q, tree.coordinates), numbers(args.v, tree.velocities),
      numbers(args.a, tree.velocities), *static_cast<const LoadsT<T>*>(args.loads),
      *static_cast<const InverseMatrices<T>*>(args.matrices));
}
template <class T>
bool run_solve(const vphysics_kernels::SolveArguments& args) {
  const auto matrix = [&](void* at) {
    return std::span<T>(static_cast<T*>(at), args.velocities * args.velocities);
  };
  return slopes::solve_kernel<T>(*static_cast<DerivativesWork<T>*>(args.memory), matrix(args.a_q),
                                 matrix(args.a_v), matrix(args.a_tau));
}

}  // namespace
}  // namespace detail
}  // namespace vp

#define VP_JOIN(a, b) a##b
#define VP_DERIVATIVES_OF(table) VP_JOIN(table, Derivatives)

namespace vphysics_kernels {
const DerivativeKernels VP_DERIVATIVES_OF(VP_KERNELS)[2] = {
    {vp::detail::run_differentiate<double>, vp::detail::run_solve<double>},
    {vp::detail::run_differentiate<float>, vp::detail::run_solve<float>}};
}  // namespace vphysics_kernels
