// The first pass, from the roots outwards: where the nodes are and how they move.
//
//   X_i = X_parent T_parent,i e^(S_i q_i)
//   S_i = Ad_X of the joint's own subspace: (z, p x z) for a revolute, (0, z) for a prismatic joint
//   V_i = V_parent + S_i q'_i
//   c_i = ad_(V_parent) (S_i q'_i) + S'_i q'_i
//
// S is fixed in the link, hence turns with V_i = V_parent + S q'; the second part drops out. S' is
// the rate of a user's joint in its own frame.
#pragma once

#include "multibody/work.h"
#include "vphysics/multibody/dynamics.h"

namespace vp::detail {

template <class T>
using Span = std::span<const T>;

template <class T>
SE3T<T> wide(const SE3T<base_t<T>>& A) {
  const auto each = [](const auto& a) { return Vec3T<T>{T(a.x), T(a.y), T(a.z)}; };
  const auto& R = A.rotation();
  return {Mat3T<T>{each(R.cx), each(R.cy), each(R.cz)}, each(A.position())};
}
template <class T>
InertiaT<T> wide(const InertiaT<base_t<T>>& J) {
  const auto& h = J.first_moment();
  const auto& I = J.rotational();
  return {T(J.mass()), Vec3T<T>{T(h.x), T(h.y), T(h.z)},
          Sym3T<T>{T(I.xx), T(I.yy), T(I.zz), T(I.xy), T(I.yz), T(I.zx)}};
}

// X turned about its z by an angle: two columns mix.
template <class T>
Mat3T<T> turned(const Mat3T<T>& R, const SinCosT<T>& k) {
  return {k.cos * R.cx + k.sin * R.cy, k.cos * R.cy - k.sin * R.cx, R.cz};
}

// The pose of the node at zero coordinates. A root is at the origin of its tree.
template <class T>
SE3T<T> zero_pose(const Node<base_t<T>>& node, const NodeState<T>* parent) {
  const SE3T<T> M = wide<T>(node.T_parent);
  if (parent == nullptr) return {M.rotation(), Vec3T<T>{T(0), T(0), T(0)}};
  return parent->X * M;
}

template <class T>
QuaternionT<T> quaternion_at(Span<T> q, std::size_t i) {
  return {q[i], q[i + 1], q[i + 2], q[i + 3]};
}

template <class T>
SE3T<T> exponential(const Node<base_t<T>>& node, const SE3T<T>& zero, Span<T> q) {
  const auto i = static_cast<std::size_t>(node.q);
  const Vec3T<T>& p = zero.position();
  const Mat3T<T>& R = zero.rotation();
  switch (node.kind) {
    case NodeKind::revolute:
      return {turned(R, sin_cos(q[i])), p};
    case NodeKind::prismatic:
      return {R, p + q[i] * R.cz};
    case NodeKind::helical:
      return {turned(R, sin_cos(q[i])), p + (T(node.pitch) * q[i]) * R.cz};
    case NodeKind::ball:
      return {R * from_quaternion(quaternion_at(q, i)), p};
    case NodeKind::free:
      return {R * from_quaternion(quaternion_at(q, i + 3)),
              p + R * Vec3T<T>{q[i], q[i + 1], q[i + 2]}};
    case NodeKind::user:
      break;
  }
  return zero;
}

template <class T>
se3T<T> subspace_of(const Node<base_t<T>>& node, const SE3T<T>& X) {
  const Vec3T<T>& z = X.rotation().cz;
  if (node.kind == NodeKind::prismatic) return {{T(0), T(0), T(0)}, z};
  const Vec3T<T> s = cross(X.position(), z);
  if (node.kind == NodeKind::revolute) return {z, s};
  return {z, s + T(node.pitch) * z};
}

// The columns of a ball's or a free node's subspace: the axes of the link.
template <class T>
void fill_subspace(const Node<base_t<T>>& node, const SE3T<T>& X, BlockState<T>& block) {
  for (int k = 0; k < 3; ++k) {
    const Vec3T<T>& axis = k == 0 ? X.rotation().cx : k == 1 ? X.rotation().cy : X.rotation().cz;
    block.S[static_cast<std::size_t>(k)] = {axis, cross(X.position(), axis)};
    if (node.dofs == 6) block.S[static_cast<std::size_t>(k + 3)] = {{T(0), T(0), T(0)}, axis};
  }
}

// Poses and subspaces, and with v velocities and velocity-product accelerations on top of A_root.
// Without v, V and A are left alone.
template <class T>
void kinematics(const Tree<base_t<T>>& tree, Work<T>& work, Span<T> q, Span<T> v,
                const se3T<T>& A_root);

template <class T>
InertiaT<T> inertia_in_tree(const Node<base_t<T>>& node, const NodeState<T>& state) {
  return wide<T>(node.J).InvXform(state.X);
}
// Of the node's own body, in the tree's frame.
template <class T>
InertiaT<T> inertia_of(const Tree<base_t<T>>& tree, const Work<T>& work, int node) {
  const auto i = static_cast<std::size_t>(node);
  return inertia_in_tree<T>(tree.nodes[i], work.nodes[i]);
}

// The loads' forces on the links, from each node's p.
template <class T>
void subtract_external(const Tree<base_t<T>>& tree, Work<T>& work, const LoadsT<T>& loads) {
  if (loads.external.empty()) return;
  for (std::size_t l = 0; l < tree.places.size(); ++l) {
    const auto& place = tree.places[l];
    if (place.node == kWorld) continue;
    NodeState<T>& state = work.nodes[static_cast<std::size_t>(place.node)];
    state.p = state.p - InvdAd(state.X * wide<T>(place.T_node_link), loads.external[l]);
  }
}

}  // namespace vp::detail
