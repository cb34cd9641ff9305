// Inverse dynamics: the recursive Newton-Euler algorithm, in the tree's frame.
//
//   outwards   A_i = A_parent + S_i q''_i + c_i,  F_i = J_i A_i - dad_(V_i) (J_i V_i) - external
//   inwards    tau_i = <S_i, F_i> + armature q''_i + damping q'_i,  F_parent += F_i
#include "multibody/instantiate.h"
#include "multibody/kinematics.h"
#include "vphysics/multibody/dynamics.h"

namespace vp {
namespace detail {
namespace {

// A is so far what the velocities make; here it becomes the whole. Parents first.
template <class T>
void accelerate(const Tree<base_t<T>>& tree, Work<T>& work, Span<T> a) {
  std::vector<NodeState<T>>& nodes = work.nodes;
  for (std::size_t i = 0; i < tree.nodes.size(); ++i) {
    const auto& node = tree.nodes[i];
    se3T<T> added =
        node.parent == kWorld ? se3T<T>{} : work.added[static_cast<std::size_t>(node.parent)];
    const auto first = static_cast<std::size_t>(node.v);
    if (node.block < 0) {
      added = added + a[first] * nodes[i].S;
    } else {
      const BlockState<T>& block = work.blocks[static_cast<std::size_t>(node.block)];
      for (std::size_t k = 0; k < static_cast<std::size_t>(node.dofs); ++k) {
        added = added + a[first + k] * block.S[k];
      }
    }
    work.added[i] = added;
    const InertiaT<T> J = inertia_in_tree<T>(node, nodes[i]);
    nodes[i].p = J * (nodes[i].A + added) - dad(nodes[i].V, J * nodes[i].V);
  }
}

template <class T>
void project(const Tree<base_t<T>>& tree, Work<T>& work, Span<T> v, Span<T> a, std::span<T> tau) {
  for (std::size_t i = tree.nodes.size(); i-- > 0;) {
    const auto& node = tree.nodes[i];
    const NodeState<T>& state = work.nodes[i];
    const auto first = static_cast<std::size_t>(node.v);
    for (std::size_t k = 0; k < static_cast<std::size_t>(node.dofs); ++k) {
      const se3T<T>& S =
          node.block < 0 ? state.S : work.blocks[static_cast<std::size_t>(node.block)].S[k];
      tau[first + k] =
          S * state.p + T(node.armature) * a[first + k] + T(node.damping) * v[first + k];
    }
    if (node.parent == kWorld) continue;
    NodeState<T>& parent = work.nodes[static_cast<std::size_t>(node.parent)];
    parent.p = parent.p + state.p;
  }
}

}  // namespace
}  // namespace detail

template <class T>
void inverse_dynamics(const ModelT<base_t<T>>& model, DataT<T>& data, std::span<const T> q,
                      std::span<const T> v, std::span<const T> a, const LoadsT<T>& loads,
                      std::span<T> tau) {
  const auto& tree = model.tree();
  detail::Work<T>& work = data.work();
  detail::kinematics<T>(tree, work, q, v, {{T(0), T(0), T(0)}, -loads.gravity});
  detail::accelerate<T>(tree, work, a);
  detail::subtract_external(tree, work, loads);
  detail::project<T>(tree, work, v, a, tau);
}

#define VP_INVERSE_DYNAMICS(T)                                                             \
  template void inverse_dynamics(const ModelT<base_t<T>>&, DataT<T>&, std::span<const T>,  \
                                 std::span<const T>, std::span<const T>, const LoadsT<T>&, \
                                 std::span<T>);
VP_FOR_EACH_SCALAR(VP_INVERSE_DYNAMICS)

}  // namespace vp
