// Forward dynamics: the articulated body algorithm, paper, appendix A, in the tree's frame.
//
//   outwards   X, S, V, A (kinematics.h); p_i = J_i A_i - dad_(V_i) (J_i V_i) - F_i
//   inwards    U_i = J^_i S_i, Omega_i = <S_i, U_i> + armature
//              J^_parent += J^_i - U_i (x) U_i / Omega_i
//   inwards    u_i = tau_i - damping q'_i - <S_i, p^_i>,  p^_parent += p^_i + U_i u_i / Omega_i
//   outwards   q''_i = (u_i - <U_i, a_parent>) / Omega_i,  a_i = a_parent + S_i q''_i
//
// A_i is the acceleration that the velocities alone make, with the field of gravity on top, so that
// the inward pass needs no J^ c; a_i is what the joints add to it. In one frame the congruence
// Ad* J^ Ad of the paper's equation (6) is the identity.
//
// A joint of several degrees is that many joints of one degree with nothing between them: inwards
// its columns are taken in their order, outwards in the opposite one.
#include "multibody/instantiate.h"
#include "multibody/kinematics.h"
#include "vphysics/multibody/dynamics.h"

namespace vp {
namespace detail {
namespace {

template <class T>
bool positive(const T& x) {
  return all(x > T(0));
}

// One degree of freedom.
template <class T>
bool factor(const Node<base_t<T>>& node, NodeState<T>& state, NodeState<T>* parent) {
  state.U = state.J * state.S;
  const T omega = state.S * state.U + T(node.armature);
  if (!positive(omega)) return false;
  state.D_inverse = T(1) / omega;
  if (parent != nullptr) parent->J = parent->J + (state.J - outer(state.D_inverse, state.U));
  return true;
}

// Several: a column at a time, each with what the columns before have left of J.
template <class T>
bool factor(const Node<base_t<T>>& node, NodeState<T>& state, BlockState<T>& block,
            NodeState<T>* parent) {
  const auto n = static_cast<std::size_t>(node.dofs);
  AInertiaT<T> J = state.J;
  for (std::size_t k = 0; k < n; ++k) {
    block.U[k] = J * block.S[k];
    const T omega = block.S[k] * block.U[k] + T(node.armature);
    if (!positive(omega)) return false;
    block.D_inverse[k] = T(1) / omega;
    J = J - outer(block.D_inverse[k], block.U[k]);
  }
  if (parent != nullptr) parent->J = parent->J + J;
  return true;
}

// Inwards: the factors, from the links' own inertias.
template <class T>
bool factor(const Tree<base_t<T>>& tree, Work<T>& work) {
  for (std::size_t i = 0; i < tree.nodes.size(); ++i) {
    work.nodes[i].J = inertia_in_tree<T>(tree.nodes[i], work.nodes[i]);
  }
  bool fine = true;
  for (std::size_t i = tree.nodes.size(); i-- > 0;) {
    const auto& node = tree.nodes[i];
    NodeState<T>* parent =
        node.parent == kWorld ? nullptr : &work.nodes[static_cast<std::size_t>(node.parent)];
    if (node.block < 0) {
      fine &= factor(node, work.nodes[i], parent);
    } else {
      fine &=
          factor(node, work.nodes[i], work.blocks[static_cast<std::size_t>(node.block)], parent);
    }
  }
  return fine;
}

// Inwards: u, what is left of the joints' forces tau, through the bias forces p.
template <class T>
void inwards(const Tree<base_t<T>>& tree, Work<T>& work, Span<T> tau) {
  for (std::size_t i = tree.nodes.size(); i-- > 0;) {
    const auto& node = tree.nodes[i];
    NodeState<T>& state = work.nodes[i];
    const auto first = static_cast<std::size_t>(node.v);
    dse3T<T> p = state.p;
    if (node.block < 0) {
      state.u = tau[first] - state.S * p;
      p = p + (state.u * state.D_inverse) * state.U;
    } else {
      BlockState<T>& block = work.blocks[static_cast<std::size_t>(node.block)];
      for (std::size_t k = 0; k < static_cast<std::size_t>(node.dofs); ++k) {
        block.u[k] = tau[first + k] - block.S[k] * p;
        p = p + (block.u[k] * block.D_inverse[k]) * block.U[k];
      }
    }
    if (node.parent == kWorld) continue;
    NodeState<T>& parent = work.nodes[static_cast<std::size_t>(node.parent)];
    parent.p = parent.p + p;
  }
}

// Outwards: the rates x that u asks for; a is the acceleration that the joints before have made.
template <class T>
void outwards(const Tree<base_t<T>>& tree, Work<T>& work, std::span<T> x) {
  for (std::size_t i = 0; i < tree.nodes.size(); ++i) {
    const auto& node = tree.nodes[i];
    NodeState<T>& state = work.nodes[i];
    se3T<T> a =
        node.parent == kWorld ? se3T<T>{} : work.added[static_cast<std::size_t>(node.parent)];
    const auto first = static_cast<std::size_t>(node.v);
    if (node.block < 0) {
      x[first] = (state.u - state.U * a) * state.D_inverse;
      a = a + x[first] * state.S;
    } else {
      BlockState<T>& block = work.blocks[static_cast<std::size_t>(node.block)];
      for (std::size_t k = static_cast<std::size_t>(node.dofs); k-- > 0;) {
        x[first + k] = (block.u[k] - block.U[k] * a) * block.D_inverse[k];
        a = a + x[first + k] * block.S[k];
      }
    }
    work.added[i] = a;
  }
}

// Bias forces: of the velocities, of gravity and of the loads.
template <class T>
void start_bias(const Tree<base_t<T>>& tree, Work<T>& work, const LoadsT<T>& loads) {
  for (std::size_t i = 0; i < tree.nodes.size(); ++i) {
    NodeState<T>& state = work.nodes[i];
    const InertiaT<T> J = inertia_in_tree<T>(tree.nodes[i], state);
    state.p = J * state.A - dad(state.V, J * state.V);
  }
  subtract_external(tree, work, loads);
}

// What the joints' viscous friction leaves of tau, in x.
template <class T>
void subtract_damping(const Tree<base_t<T>>& tree, Span<T> v, Span<T> tau, std::span<T> x) {
  for (const auto& node : tree.nodes) {
    for (int k = node.v; k < node.v + node.dofs; ++k) {
      const auto i = static_cast<std::size_t>(k);
      x[i] = tau[i] - T(node.damping) * v[i];
    }
  }
}

Expected<void> no_inertia(const char* call) {
  return tl::make_unexpected(
      Error{Errc::singular, std::string(call) +
                                ": a joint moves no inertia in this configuration; give its links "
                                "an inertia, or the joint an armature"});
}

}  // namespace
}  // namespace detail

template <class T>
Expected<void> forward_dynamics(const ModelT<base_t<T>>& model, DataT<T>& data,
                                std::span<const T> q, std::span<const T> v, std::span<const T> tau,
                                const LoadsT<T>& loads, std::span<T> a) {
  const auto& tree = model.tree();
  detail::Work<T>& work = data.work();
  detail::kinematics<T>(tree, work, q, v, {{T(0), T(0), T(0)}, -loads.gravity});
  detail::start_bias<T>(tree, work, loads);
  if (!detail::factor<T>(tree, work)) return detail::no_inertia("forward_dynamics");
  detail::subtract_damping<T>(tree, v, tau, a);
  detail::inwards<T>(tree, work, a);
  detail::outwards<T>(tree, work, a);
  return {};
}

template <class T>
Expected<void> factor_mass(const ModelT<base_t<T>>& model, DataT<T>& data, std::span<const T> q) {
  detail::kinematics<T>(model.tree(), data.work(), q, {}, {});
  if (!detail::factor<T>(model.tree(), data.work())) return detail::no_inertia("factor_mass");
  return {};
}

template <class T>
void solve_mass(const ModelT<base_t<T>>& model, DataT<T>& data, std::span<T> x) {
  for (auto& node : data.work().nodes) node.p = {};
  detail::inwards<T>(model.tree(), data.work(), x);
  detail::outwards<T>(model.tree(), data.work(), x);
}

#define VP_FORWARD_DYNAMICS(T)                                                                  \
  template Expected<void> forward_dynamics(const ModelT<base_t<T>>&, DataT<T>&,                 \
                                           std::span<const T>, std::span<const T>,              \
                                           std::span<const T>, const LoadsT<T>&, std::span<T>); \
  template Expected<void> factor_mass(const ModelT<base_t<T>>&, DataT<T>&, std::span<const T>); \
  template void solve_mass(const ModelT<base_t<T>>&, DataT<T>&, std::span<T>);
VP_FOR_EACH_SCALAR(VP_FORWARD_DYNAMICS)

}  // namespace vp
