#include "multibody/kinematics.h"

#include "multibody/instantiate.h"
#include "vphysics/multibody/dynamics.h"

namespace vp {
namespace detail {
namespace {

double lane_of(double x, int) {
  return x;
}
double lane_of(float x, int) {
  return static_cast<double>(x);
}
template <class B, int N>
double lane_of(const PackT<B, N>& x, int lane) {
  return static_cast<double>(x[lane]);
}
void set_lane(double& x, int, double value) {
  x = value;
}
void set_lane(float& x, int, double value) {
  x = static_cast<float>(value);
}
template <class B, int N>
void set_lane(PackT<B, N>& x, int lane, double value) {
  x.set(lane, static_cast<B>(value));
}
template <class T>
void set_lane(Vec3T<T>& a, int lane, const Vec3& value) {
  for (int i = 0; i < 3; ++i) set_lane(a[i], lane, value[i]);
}
template <class T>
void set_lane(se3T<T>& V, int lane, const se3& value) {
  set_lane(V.w, lane, value.w);
  set_lane(V.v, lane, value.v);
}
template <class T>
constexpr int lanes_of() {
  if constexpr (requires { T::kLanes; }) {
    return T::kLanes;
  } else {
    return 1;
  }
}

// The subspace and its rate, in the link's frame.
template <class T>
SE3T<T> evaluate_user(const Node<base_t<T>>& node, Span<T> q, Span<T> v, BlockState<T>& block,
                      se3T<T>& rate) {
  const auto dofs = static_cast<std::size_t>(node.dofs);
  Mat3T<T> R{};
  Vec3T<T> p;
  for (int lane = 0; lane < lanes_of<T>(); ++lane) {
    std::array<double, 6> q_lane{}, v_lane{};
    for (std::size_t k = 0; k < dofs; ++k) {
      q_lane[k] = lane_of(q[static_cast<std::size_t>(node.q) + k], lane);
      if (!v.empty()) v_lane[k] = lane_of(v[static_cast<std::size_t>(node.v) + k], lane);
    }
    SE3 X;
    std::array<se3, 6> S{};
    se3 S_rate;
    node.user->evaluate(std::span(q_lane).first(dofs), std::span(v_lane).first(dofs), X,
                        std::span(S).first(dofs), S_rate);
    set_lane(R.cx, lane, X.rotation().cx);
    set_lane(R.cy, lane, X.rotation().cy);
    set_lane(R.cz, lane, X.rotation().cz);
    set_lane(p, lane, X.position());
    for (std::size_t k = 0; k < dofs; ++k) set_lane(block.S[k], lane, S[k]);
    set_lane(rate, lane, S_rate);
  }
  return {R, p};
}

template <class T>
void place(const Node<base_t<T>>& node, NodeState<T>& state, const SE3T<T>& zero, Span<T> q) {
  state.X = exponential(node, zero, q);
  state.S = subspace_of(node, state.X);
}

}  // namespace

template <class T>
void kinematics(const Tree<base_t<T>>& tree, Work<T>& work, Span<T> q, Span<T> v,
                const se3T<T>& A_root) {
  const se3T<T> rest{};
  for (std::size_t i = 0; i < tree.nodes.size(); ++i) {
    const auto& node = tree.nodes[i];
    NodeState<T>& state = work.nodes[i];
    const bool root = node.parent == kWorld;
    const NodeState<T>* parent =
        root ? nullptr : &work.nodes[static_cast<std::size_t>(node.parent)];
    const SE3T<T> zero = zero_pose(node, parent);
    if (root) {
      const auto& p = node.T_parent.position();
      work.origins[i] = {T(p.x), T(p.y), T(p.z)};
    } else {
      work.origins[i] = work.origins[static_cast<std::size_t>(node.parent)];
    }
    const se3T<T>& V = root ? rest : parent->V;
    const se3T<T>& A = root ? A_root : parent->A;
    if (node.block < 0) {
      place(node, state, zero, q);
      if (v.empty()) continue;
      const se3T<T> own = v[static_cast<std::size_t>(node.v)] * state.S;
      state.V = V + own;
      state.A = A + ad(V, own);
      continue;
    }
    BlockState<T>& block = work.blocks[static_cast<std::size_t>(node.block)];
    se3T<T> rate{};
    if (node.kind == NodeKind::user) {
      state.X = zero * evaluate_user(node, q, v, block, rate);
      for (std::size_t k = 0; k < static_cast<std::size_t>(node.dofs); ++k) {
        block.S[k] = Ad(state.X, block.S[k]);
      }
      rate = Ad(state.X, rate);
    } else {
      state.X = exponential(node, zero, q);
      if (root && node.kind == NodeKind::free) {
        work.origins[i] += state.X.position();
        state.X = SE3T<T>(state.X.rotation(), Vec3T<T>{T(0), T(0), T(0)});
      }
      fill_subspace(node, state.X, block);
    }
    if (v.empty()) continue;
    se3T<T> own{};
    for (std::size_t k = 0; k < static_cast<std::size_t>(node.dofs); ++k) {
      own = own + v[static_cast<std::size_t>(node.v) + k] * block.S[k];
    }
    state.V = V + own;
    state.A = A + ad(V, own) + rate;
  }
}

}  // namespace detail

template <class T>
void forward_kinematics(const ModelT<base_t<T>>& model, DataT<T>& data, std::span<const T> q,
                        std::span<const T> v) {
  detail::kinematics(model.tree(), data.work(), q, v, se3T<T>{});
}

template <class T>
SE3T<T> T_world_link(const ModelT<base_t<T>>& model, const DataT<T>& data, int link) {
  const auto& place = model.tree().places[static_cast<std::size_t>(link)];
  const SE3T<T> T_node_link = detail::wide<T>(place.T_node_link);
  if (place.node == kWorld) return T_node_link;
  const auto node = static_cast<std::size_t>(place.node);
  const SE3T<T>& X = data.work().nodes[node].X;
  return SE3T<T>(X.rotation(), X.position() + data.work().origins[node]) * T_node_link;
}

template <class T>
se3T<T> link_velocity(const ModelT<base_t<T>>& model, const DataT<T>& data, int link) {
  const auto& place = model.tree().places[static_cast<std::size_t>(link)];
  if (place.node == kWorld) return {};
  const auto node = static_cast<std::size_t>(place.node);
  const auto& state = data.work().nodes[node];
  SE3T<T> X = T_world_link<T>(model, data, link);
  X = SE3T<T>(X.rotation(), X.position() - data.work().origins[node]);
  return InvAd(X, state.V);
}

template <class T>
DataT<T>::DataT(const ModelT<base_t<T>>& model)
    : work_(std::make_unique<detail::Work<T>>(model.tree())) {}
template <class T>
DataT<T>::~DataT() = default;
template <class T>
DataT<T>::DataT(DataT&&) noexcept = default;
template <class T>
DataT<T>& DataT<T>::operator=(DataT&&) noexcept = default;

template <class T>
detail::Work<T>::Work(const Tree<base_t<T>>& tree)
    : nodes(tree.nodes.size()),
      blocks(static_cast<std::size_t>(tree.blocks)),
      composites(tree.nodes.size()),
      added(tree.nodes.size()),
      origins(tree.nodes.size()),
      zeros(static_cast<std::size_t>(tree.velocities), T(0)) {}

#define VP_KINEMATICS(T)                                                                    \
  template struct detail::Work<T>;                                                          \
  template class DataT<T>;                                                                  \
  template void detail::kinematics(const detail::Tree<base_t<T>>&, detail::Work<T>&,        \
                                   std::span<const T>, std::span<const T>, const se3T<T>&); \
  template void forward_kinematics(const ModelT<base_t<T>>&, DataT<T>&, std::span<const T>, \
                                   std::span<const T>);                                     \
  template SE3T<T> T_world_link(const ModelT<base_t<T>>&, const DataT<T>&, int);            \
  template se3T<T> link_velocity(const ModelT<base_t<T>>&, const DataT<T>&, int);
VP_FOR_EACH_SCALAR(VP_KINEMATICS)

}  // namespace vp
