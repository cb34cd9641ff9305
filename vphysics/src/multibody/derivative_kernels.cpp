// The passes of the derivatives for one instruction set. The build names the set as for
// kernels.cpp.
#include "multibody/derivative_kernels.h"

#include "multibody/differentiate.h"
#include "multibody/instantiate.h"
#include "multibody/solve_rows.h"

namespace vp {
namespace detail {
namespace {

using vphysics_kernels::DerivativeArguments;
using vphysics_kernels::Differentiated;

template <class T>
struct DerivativeCall {
  explicit DerivativeCall(const DerivativeArguments& arguments)
      : args(arguments),
        tree(*static_cast<const Tree<base_t<T>>*>(args.tree)),
        work(*static_cast<Work<T>*>(args.work)),
        memory(*static_cast<DerivativesWork<T>*>(args.memory)) {}

  std::size_t size() const { return memory.velocities(); }
  derivatives::State<T> state() const {
    const auto numbers = [](const void* at, int count) {
      return Span<T>(static_cast<const T*>(at), static_cast<std::size_t>(count));
    };
    const T zero(0);
    return {tree,
            work,
            numbers(args.q, tree.coordinates),
            numbers(args.v, tree.velocities),
            numbers(args.a, tree.velocities),
            {{zero, zero, zero}, -*static_cast<const Vec3T<T>*>(args.gravity)}};
  }
  Span<dse3T<T>> external() const {
    if (args.external == nullptr) return {};
    return {static_cast<const dse3T<T>*>(args.external), tree.frames.size()};
  }
  // A result matrix, filled with zeros.
  T* zeros(void* at) const {
    T* const out = static_cast<T*>(at);
    std::fill_n(out, size() * size(), T(0));
    return out;
  }

  const DerivativeArguments& args;
  const Tree<base_t<T>>& tree;
  Work<T>& work;
  DerivativesWork<T>& memory;
};

template <class T>
Differentiated run_inverse(const DerivativeArguments& args) {
  const DerivativeCall<T> c(args);
  const std::size_t n = c.size();
  const InverseMatrices<T> out{
      {c.zeros(args.by_q), n}, {c.zeros(args.by_v), n}, {c.zeros(args.by_force), n}};
  return derivatives::differentiate(c.state(), c.memory, c.external(), true, out)
             ? Differentiated::done
             : Differentiated::no_derivatives;
}

// A pack of states is solved in place, in the result matrices.
template <class T>
Differentiated forward_of_states(const DerivativeCall<T>& c) {
  const std::size_t n = c.size();
  T* const by_q = c.zeros(c.args.by_q);
  T* const by_v = c.zeros(c.args.by_v);
  if (!derivatives::differentiate(c.state(), c.memory, c.external(), false,
                                  {{by_q, n}, {by_v, n}, c.memory.L})) {
    return Differentiated::no_derivatives;
  }
  if (!derivatives::factor_mass(c.tree, c.work, c.memory)) return Differentiated::singular;
  derivatives::solve(c.memory, by_q, n, 1);
  derivatives::solve(c.memory, by_v, n, 1);
  T* const inverse = c.zeros(c.args.by_force);
  derivatives::invert(c.memory, inverse, n);
  for (std::size_t i = 0; i < n; ++i) {
    for (std::size_t k = 0; k < i; ++k) inverse[i * n + k] = inverse[k * n + i];
  }
  return Differentiated::done;
}

// A single state is solved in rows of whole registers, then copied to the results.
template <class T>
Differentiated forward_of_one(const DerivativeCall<T>& c) {
  constexpr auto kGroup = static_cast<std::size_t>(kSlots<T>);
  DerivativesWork<T>& memory = c.memory;
  const std::size_t n = c.size(), groups = static_cast<std::size_t>(memory.groups());
  const std::size_t width = 2 * kGroup * groups;
  std::fill_n(memory.both.data(), memory.both.size(), T(0));
  std::fill_n(memory.inverse.data(), memory.inverse.size(), T(0));
  const MatrixView<T> Q{memory.both.data(), width, 2 * kGroup};
  const MatrixView<T> V{memory.both.data() + kGroup, width, 2 * kGroup};
  if (!derivatives::differentiate(c.state(), memory, c.external(), false, {Q, V, memory.L})) {
    return Differentiated::no_derivatives;
  }
  if (!derivatives::factor_mass(c.tree, c.work, memory)) return Differentiated::singular;
  derivatives::solve(memory, memory.both.data(), width, 2);
  derivatives::invert(memory, memory.inverse.data(), memory.row_size);
  T* const by_q = static_cast<T*>(c.args.by_q);
  T* const by_v = static_cast<T*>(c.args.by_v);
  T* const inverse = static_cast<T*>(c.args.by_force);
  for (std::size_t i = 0; i < n; ++i) {
    for (std::size_t g = 0; g < groups; ++g) {
      const std::size_t first = g * kGroup;
      const int count = static_cast<int>(std::min(kGroup, n - first));
      const Wide<T> q = load<Wide<T>>(Q.group(i, g)), v = load<Wide<T>>(V.group(i, g));
      store_lanes(by_q + i * n + first, q, 0, count);
      store_lanes(by_v + i * n + first, v, 0, count);
    }
    const T* const row = memory.inverse.data() + i * memory.row_size;
    for (std::size_t k = i; k < n; ++k) inverse[i * n + k] = inverse[k * n + i] = row[k];
  }
  return Differentiated::done;
}

template <class T>
Differentiated run_forward(const DerivativeArguments& args) {
  const DerivativeCall<T> c(args);
  if constexpr (kSlots<T> == 1) {
    return forward_of_states(c);
  } else {
    return forward_of_one(c);
  }
}

constexpr vphysics_kernels::DerivativeTable derivative_table() {
#define VP_TABLE_ENTRY(T) vphysics_kernels::DerivativeKernels{run_inverse<T>, run_forward<T>},
  return {{VP_FOR_EACH_SCALAR(VP_TABLE_ENTRY)}};
#undef VP_TABLE_ENTRY
}

}  // namespace
}  // namespace detail
}  // namespace vp

#define VP_JOIN(a, b) a##b
#define VP_DERIVATIVES_OF(table) VP_JOIN(table, Derivatives)

const vphysics_kernels::DerivativeTable vphysics_kernels::VP_DERIVATIVES_OF(VP_KERNELS) =
    vp::detail::derivative_table();
