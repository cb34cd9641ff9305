// The passes of one instruction set for every scalar (kernels.h). The build names the set:
// VP_KERNELS is the name of the table, and, except for the baseline, vp is a namespace of the set.
#include "multibody/kernels.h"

#include "multibody/forward_dynamics.h"
#include "multibody/instantiate.h"
#include "multibody/inverse_dynamics.h"
#include "multibody/mass_matrix.h"

namespace vp {
namespace detail {
namespace {

using vphysics_kernels::Arguments;
using vphysics_kernels::Kernels;

template <class T>
struct Call {
  explicit Call(const Arguments& arguments)
      : args(arguments),
        tree(*static_cast<const Tree<base_t<T>>*>(args.tree)),
        work(*static_cast<Work<T>*>(args.work)) {}

  std::size_t velocities() const { return static_cast<std::size_t>(tree.velocities); }
  Span<T> q() const {
    return {static_cast<const T*>(args.q), static_cast<std::size_t>(tree.coordinates)};
  }
  Span<T> v() const { return of_velocities(args.v); }
  Span<T> given() const { return of_velocities(args.given); }
  const Vec3T<T>& gravity() const { return *static_cast<const Vec3T<T>*>(args.gravity); }
  Span<dse3T<T>> external() const {
    if (args.external == nullptr) return {};
    return {static_cast<const dse3T<T>*>(args.external), tree.frames.size()};
  }
  std::span<T> out(std::size_t size) const { return {static_cast<T*>(args.out), size}; }

  const Arguments& args;
  const Tree<base_t<T>>& tree;
  Work<T>& work;

 private:
  Span<T> of_velocities(const void* at) const {
    if (at == nullptr) return {};
    return {static_cast<const T*>(at), velocities()};
  }
};

template <class T>
bool run_kinematics(const Arguments& args) {
  const Call<T> c(args);
  const auto no_body = [](const auto&, const auto&) { return 0; };
  const auto nothing = [](int, int, const auto&, const auto&) {};
  if (c.v().empty()) {
    pass_base_to_tip<T, PassDepth::poses>(c.tree, c.work, c.q(), {}, {}, no_body, nothing);
  } else {
    pass_base_to_tip<T, PassDepth::velocities>(c.tree, c.work, c.q(), c.v(), {}, no_body, nothing);
  }
  return true;
}
template <class T>
bool run_forward_dynamics(const Arguments& args) {
  const Call<T> c(args);
  return forward_dynamics_kernel<T>(c.tree, c.work, c.q(), c.v(), c.given(), c.gravity(),
                                    c.external(), c.out(c.velocities()));
}
template <class T>
bool run_factor_mass(const Arguments& args) {
  const Call<T> c(args);
  return factor_mass_kernel<T>(c.tree, c.work, c.q());
}
template <class T>
bool run_solve_mass(const Arguments& args) {
  const Call<T> c(args);
  solve_mass_kernel<T>(c.tree, c.work, c.out(c.velocities()));
  return true;
}
template <class T>
bool run_inverse_dynamics(const Arguments& args) {
  const Call<T> c(args);
  inverse_dynamics_kernel<T>(c.tree, c.work, c.q(), c.v(), c.given(), c.gravity(), c.external(),
                             c.out(c.velocities()));
  return true;
}
template <class T>
bool run_mass_matrix(const Arguments& args) {
  const Call<T> c(args);
  mass_matrix_kernel<T>(c.tree, c.work, c.q(), c.out(c.velocities() * c.velocities()));
  return true;
}

template <class T>
constexpr Kernels kernels() {
  return {run_kinematics<T>, run_forward_dynamics<T>, run_factor_mass<T>,
          run_solve_mass<T>, run_inverse_dynamics<T>, run_mass_matrix<T>};
}

}  // namespace

#ifdef VP_SAME_BITS
constexpr Kernels table() {
  return kernels<double>();
}
#else
constexpr vphysics_kernels::Table table() {
#define VP_TABLE_ENTRY(T) kernels<T>(),
  return {{VP_FOR_EACH_SCALAR(VP_TABLE_ENTRY)}};
#undef VP_TABLE_ENTRY
}
#endif

}  // namespace detail
}  // namespace vp

#ifdef VP_SAME_BITS
const vphysics_kernels::Kernels vphysics_kernels::VP_KERNELS = vp::detail::table();
#else
const vphysics_kernels::Table vphysics_kernels::VP_KERNELS = vp::detail::table();
#endif
