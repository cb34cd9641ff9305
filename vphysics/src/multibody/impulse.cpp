// Impulses through the articulated body recursion, in the tree's frame.
//
// A joint k between a link and its parent transmits a velocity V from base to tip and an impulse F
// from tip to base as
//   P_k V = V - S_k <U_k, V> / Omega_k        P_k^T F = F - U_k <S_k, F> / Omega_k
// and therefore, with L the inverse inertia of a link,
//   L_child = P_k L_parent P_k^T + S_k (x) S_k / Omega_k
//   L_ab    = P_(c->a) L_c P_(c->b)^T         c: the last common ancestor of a and b
#include "vphysics/multibody/impulse.h"

#include <algorithm>

#include "multibody/instantiate.h"
#include "multibody/kinematics.h"

namespace vp {
namespace detail {
namespace {

// One column of a joint: L <- P L P^T + d S S^T. With W = U d and y = L W this is
//   L - (S y^T + y S^T) + (<W, y> + d) S S^T.
template <class T>
InverseInertiaT<T> through(const InverseInertiaT<T>& L, const se3T<T>& S, const dse3T<T>& W,
                           const T& d) {
  const se3T<T> y = L * W;
  const T half = T(0.5) * (W * y + d);
  const se3T<T> z = half * S - y;  // the sum is S z^T + z S^T
  const auto symmetric = [](const Vec3T<T>& a, const Vec3T<T>& b) {
    return Sym3T<T>{T(2) * a.x * b.x,      T(2) * a.y * b.y,      T(2) * a.z * b.z,
                    a.x * b.y + b.x * a.y, a.y * b.z + b.y * a.z, a.z * b.x + b.z * a.x};
  };
  const auto column = [&](const T& s, const T& t) { return t * S.w + s * z.w; };
  return {L.A + symmetric(S.w, z.w),
          L.B + Mat3T<T>{column(S.v.x, z.v.x), column(S.v.y, z.v.y), column(S.v.z, z.v.z)},
          L.C + symmetric(S.v, z.v)};
}

// Transmits an impulse on a node to its parent.
template <class T>
dse3T<T> transmit_to_parent(const Tree<base_t<T>>& tree, const Work<T>& work, int node,
                            dse3T<T> F) {
  for (int k = tree.nodes[static_cast<std::size_t>(node)].dofs; k-- > 0;) {
    F = F - (factored_column_of<T>(tree, work, node, k) * F) *
                projected_wrench_of<T>(tree, work, node, k);
  }
  return F;
}

// The link's frame in its tree's frame, to transform impulses at the link's origin.
template <class T>
SE3T<T> T_tree_link(const Tree<base_t<T>>& tree, const Work<T>& work, int link) {
  const auto& frame = tree.frames[static_cast<std::size_t>(link)];
  return pose_of(work, frame.node) * wide<T>(frame.T_node_link);
}

template <class T>
using SixImpulses = std::array<dse3T<T>, 6>;

template <class T>
SixImpulses<T> unit_impulses(const SE3T<T>& T_tree_link) {
  SixImpulses<T> out;
  for (int k = 0; k < 6; ++k) {
    dse3T<T> F{};
    (k < 3 ? F.m : F.f)[k % 3] = T(1);
    out[static_cast<std::size_t>(k)] = InvdAd(T_tree_link, F);
  }
  return out;
}

}  // namespace
}  // namespace detail

template <class T>
void impulse_response(const ModelT<base_t<T>>& model, DataT<T>& data, int link, const dse3T<T>& F,
                      std::span<T> dv) {
  const auto& tree = model.tree();
  const detail::Work<T>& work = data.work();
  std::fill(dv.begin(), dv.end(), T(0));
  int i = tree.frames[static_cast<std::size_t>(link)].node;
  if (i == kWorld) return;
  const dse3T<T> in_tree = InvdAd(detail::T_tree_link(tree, work, link), F);
  for (; i != kWorld; i = tree.nodes[static_cast<std::size_t>(i)].parent) {
    const auto& node = tree.nodes[static_cast<std::size_t>(i)];
    for (int k = 0; k < node.dofs; ++k) {
      dv[static_cast<std::size_t>(node.v + k)] = detail::column_of<T>(tree, work, i, k) * in_tree;
    }
  }
  solve_mass<T>(model, data, dv);
}

template <class T>
InverseInertiasT<T>::InverseInertiasT(const ModelT<base_t<T>>& model)
    : of_node_(model.tree().nodes.size()) {}

template <class T>
void InverseInertiasT<T>::update(const ModelT<base_t<T>>& model, const DataT<T>& data) {
  const auto& tree = model.tree();
  const detail::Work<T>& work = data.work();
  for (std::size_t i = 0; i < tree.nodes.size(); ++i) {
    const int node = static_cast<int>(i), parent = tree.nodes[i].parent;
    InverseInertiaT<T> L{};
    if (parent != kWorld) L = of_node_[static_cast<std::size_t>(parent)];
    for (int k = 0; k < tree.nodes[i].dofs; ++k) {
      L = detail::through<T>(L, detail::factored_column_of<T>(tree, work, node, k),
                             detail::projected_wrench_of<T>(tree, work, node, k),
                             detail::omega_inverse_of<T>(tree, work, node, k));
    }
    of_node_[i] = L;
  }
}

template <class T>
ResponseT<T> InverseInertiasT<T>::between(const ModelT<base_t<T>>& model, const DataT<T>& data,
                                          int a, int b) const {
  const auto& tree = model.tree();
  const detail::Work<T>& work = data.work();
  int i = tree.frames[static_cast<std::size_t>(a)].node;
  int j = tree.frames[static_cast<std::size_t>(b)].node;
  ResponseT<T> out{};
  if (i == kWorld || j == kWorld) return out;
  auto at_a = detail::unit_impulses<T>(detail::T_tree_link(tree, work, a));
  auto at_b = detail::unit_impulses<T>(detail::T_tree_link(tree, work, b));
  while (i != j) {  // the node with the higher index is not an ancestor of the other
    const bool a_is_later = i > j;
    int& later = a_is_later ? i : j;
    for (dse3T<T>& F : a_is_later ? at_a : at_b) {
      F = detail::transmit_to_parent<T>(tree, work, later, F);
    }
    later = tree.nodes[static_cast<std::size_t>(later)].parent;
  }
  if (i == kWorld) return out;
  for (std::size_t column = 0; column < 6; ++column) {
    const se3T<T> V = of_node_[static_cast<std::size_t>(i)] * at_b[column];
    se3T<T>& c = out.columns[column];
    c.w = {at_a[0] * V, at_a[1] * V, at_a[2] * V};
    c.v = {at_a[3] * V, at_a[4] * V, at_a[5] * V};
  }
  return out;
}

#define VP_IMPULSE(T)                                                                       \
  template void impulse_response(const ModelT<base_t<T>>&, DataT<T>&, int, const dse3T<T>&, \
                                 std::span<T>);                                             \
  template class InverseInertiasT<T>;
VP_FOR_EACH_SCALAR(VP_IMPULSE)

}  // namespace vp
