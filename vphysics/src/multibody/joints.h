// Nodes that are not simple: ball, free and user joints, one at a time.
#pragma once

#include <span>

#include "multibody/work.h"

namespace vp::detail {

template <class T>
using Span = std::span<const T>;

template <class T>
Vec3T<T> wide(const Vec3T<base_t<T>>& a) {
  return {T(a.x), T(a.y), T(a.z)};
}
template <class T>
SE3T<T> wide(const SE3T<base_t<T>>& A) {
  const auto& R = A.rotation();
  return {Mat3T<T>{wide<T>(R.cx), wide<T>(R.cy), wide<T>(R.cz)}, wide<T>(A.position())};
}
template <class T>
InertiaT<T> wide(const InertiaT<base_t<T>>& J) {
  const auto& h = J.first_moment();
  const auto& I = J.rotational();
  return {T(J.mass()), Vec3T<T>{T(h.x), T(h.y), T(h.z)},
          Sym3T<T>{T(I.xx), T(I.yy), T(I.zz), T(I.xy), T(I.yz), T(I.zx)}};
}

// Access to a scalar lane by lane, in double.
template <class T>
inline constexpr int kLanesOf = 1;
template <class B, int N>
inline constexpr int kLanesOf<PackT<B, N>> = N;

template <class T>
double lane_of(const T& x, int lane) {
  if constexpr (kLanesOf<T> == 1) {
    return static_cast<double>(x);
  } else {
    return static_cast<double>(x[lane]);
  }
}
template <class T>
void set_lane(T& x, int lane, double value) {
  if constexpr (kLanesOf<T> == 1) {
    x = static_cast<T>(value);
  } else {
    x.set(lane, static_cast<base_t<T>>(value));
  }
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

// A user joint: its pose in the joint's frame; columns and rate in the link's frame.
template <class T>
SE3T<T> evaluate_user(const Node<base_t<T>>& node, Span<T> q, Span<T> v, Columns<T>& columns) {
  const auto dofs = static_cast<std::size_t>(node.dofs);
  Mat3T<T> R{};
  Vec3T<T> p;
  for (int lane = 0; lane < kLanesOf<T>; ++lane) {
    double q_lane[6] = {}, v_lane[6] = {};
    for (std::size_t k = 0; k < dofs; ++k) {
      q_lane[k] = lane_of(q[static_cast<std::size_t>(node.q) + k], lane);
      if (!v.empty()) v_lane[k] = lane_of(v[static_cast<std::size_t>(node.v) + k], lane);
    }
    SE3 X;
    se3 S[6], rate;
    node.user->evaluate({q_lane, dofs}, {v_lane, dofs}, X, {S, dofs}, rate);
    set_lane(R.cx, lane, X.rotation().cx);
    set_lane(R.cy, lane, X.rotation().cy);
    set_lane(R.cz, lane, X.rotation().cz);
    set_lane(p, lane, X.position());
    for (std::size_t k = 0; k < dofs; ++k) set_lane(columns.S[k], lane, S[k]);
    set_lane(columns.rate, lane, rate);
  }
  return {R, p};
}

template <class T>
QuaternionT<T> quaternion_at(Span<T> q, int i) {
  const auto k = static_cast<std::size_t>(i);
  return {q[k], q[k + 1], q[k + 2], q[k + 3]};
}

// For a node that is neither simple nor a free root. place_columns returns its pose in its parent's
// frame. open_columns then computes its columns in the tree's frame from its pose there.
template <class T>
VP_NOINLINE SE3T<T> place_columns(const Node<base_t<T>>& node, Span<T> q, Span<T> v,
                                  Columns<T>& columns) {
  const Vec3T<T> nowhere{T(0), T(0), T(0)};
  SE3T<T> zero = wide<T>(node.T_parent);
  if (node.parent == kWorld) zero = {zero.rotation(), nowhere};
  columns.rate = {nowhere, nowhere};
  if (node.kind == NodeKind::user) return zero * evaluate_user<T>(node, q, v, columns);
  const bool free = node.kind == NodeKind::free;
  Vec3T<T> p = zero.position();
  if (free) {
    const auto i = static_cast<std::size_t>(node.q);
    p += zero.rotation() * Vec3T<T>{q[i], q[i + 1], q[i + 2]};
  }
  return {zero.rotation() * from_quaternion(quaternion_at<T>(q, free ? node.q + 3 : node.q)), p};
}
template <class T>
VP_NOINLINE void open_columns(const Node<base_t<T>>& node, const SE3T<T>& X, Columns<T>& columns) {
  if (node.kind == NodeKind::user) {
    for (int k = 0; k < node.dofs; ++k) {
      se3T<T>& S = columns.S[static_cast<std::size_t>(k)];
      S = Ad(X, S);
    }
    columns.rate = Ad(X, columns.rate);
    return;
  }
  // The axes of the link.
  const Mat3T<T>& R = X.rotation();
  const Vec3T<T> nowhere{T(0), T(0), T(0)};
  for (int k = 0; k < 3; ++k) {
    const Vec3T<T>& axis = k == 0 ? R.cx : k == 1 ? R.cy : R.cz;
    const auto n = static_cast<std::size_t>(k);
    columns.S[n] = {axis, cross(X.position(), axis)};
    if (node.kind == NodeKind::free) columns.S[n + 3] = {nowhere, axis};
  }
}

}  // namespace vp::detail
