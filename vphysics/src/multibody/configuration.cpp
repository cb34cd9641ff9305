// q [+] delta and q1 [-] q0. The rotation of a ball or free joint is updated by quaternion
// multiplication:
//
//   r [+] w = r exp(w / 2),   r1 [-] r0 = 2 log(conj(r0) r1)
//
// The position of a free joint moves along the screw: p + R (J_l(w) v).
#include "vphysics/multibody/configuration.h"

#include "multibody/instantiate.h"
#include "multibody/tree.h"
#include "vphysics/assert.h"

namespace vp {
namespace {

using detail::Node;
using detail::NodeKind;

template <class T>
QuaternionT<T> quaternion_of(std::span<const T> q, std::size_t at) {
  return {q[at], q[at + 1], q[at + 2], q[at + 3]};
}
template <class T>
Vec3T<T> vector_of(std::span<const T> q, std::size_t at) {
  return {q[at], q[at + 1], q[at + 2]};
}
template <class T>
void put(std::span<T> out, std::size_t at, const Vec3T<T>& a) {
  for (int i = 0; i < 3; ++i) out[at + static_cast<std::size_t>(i)] = a[i];
}
template <class T>
void put(std::span<T> out, std::size_t at, const QuaternionT<T>& r) {
  out[at] = r.x;
  out[at + 1] = r.y;
  out[at + 2] = r.z;
  out[at + 3] = r.w;
}

// Index of the first coordinate of a node's quaternion.
template <class B>
std::size_t quaternion_at(const Node<B>& node) {
  return static_cast<std::size_t>(node.kind == NodeKind::free ? node.q + 3 : node.q);
}

template <class T>
void move(const Node<base_t<T>>& node, std::span<const T> q, std::span<const T> delta,
          std::span<T> out) {
  const auto c = static_cast<std::size_t>(node.q), v = static_cast<std::size_t>(node.v);
  if (node.kind != NodeKind::ball && node.kind != NodeKind::free) {
    for (std::size_t k = 0; k < static_cast<std::size_t>(node.dofs); ++k) {
      out[c + k] = q[c + k] + delta[v + k];
    }
    return;
  }
  const Vec3T<T> w = vector_of(delta, v);
  const QuaternionT<T> rotation = quaternion_of(q, quaternion_at(node));
  if (node.kind == NodeKind::free) {
    const SE3T<T> step = Exp(se3T<T>{w, vector_of(delta, v + 3)});
    put(out, c, vector_of(q, c) + from_quaternion(rotation) * step.position());
  }
  put(out, quaternion_at(node), normalized(rotation * exp_quaternion(w)));
}

template <class T>
void subtract(const Node<base_t<T>>& node, std::span<const T> q0, std::span<const T> q1,
              std::span<T> delta) {
  const auto c = static_cast<std::size_t>(node.q), v = static_cast<std::size_t>(node.v);
  if (node.kind != NodeKind::ball && node.kind != NodeKind::free) {
    for (std::size_t k = 0; k < static_cast<std::size_t>(node.dofs); ++k) {
      delta[v + k] = q1[c + k] - q0[c + k];
    }
    return;
  }
  const QuaternionT<T> rotation = quaternion_of(q0, quaternion_at(node));
  const Vec3T<T> w = Log(normalized(conjugate(rotation) * quaternion_of(q1, quaternion_at(node))));
  put(delta, v, w);
  if (node.kind == NodeKind::free) {
    const Vec3T<T> p =
        transposed_times(from_quaternion(rotation), vector_of(q1, c) - vector_of(q0, c));
    put(delta, v + 3, left_jacobian_inverse(w) * p);
  }
}

}  // namespace

template <class T>
void integrate(const ModelT<base_t<T>>& model, std::span<const T> q, std::span<const T> delta,
               std::span<T> out) {
  const auto& tree = model.tree();
  VP_ASSERT(q.size() == static_cast<std::size_t>(tree.coordinates) && out.size() == q.size());
  VP_ASSERT(delta.size() == static_cast<std::size_t>(tree.velocities));
  for (const auto& node : tree.nodes) move<T>(node, q, delta, out);
}

template <class T>
void difference(const ModelT<base_t<T>>& model, std::span<const T> q0, std::span<const T> q1,
                std::span<T> delta) {
  const auto& tree = model.tree();
  VP_ASSERT(q0.size() == static_cast<std::size_t>(tree.coordinates) && q1.size() == q0.size());
  VP_ASSERT(delta.size() == static_cast<std::size_t>(tree.velocities));
  for (const auto& node : tree.nodes) subtract<T>(node, q0, q1, delta);
}

#define VP_CONFIGURATION(T)                                                                  \
  template void integrate(const ModelT<base_t<T>>&, std::span<const T>, std::span<const T>,  \
                          std::span<T>);                                                     \
  template void difference(const ModelT<base_t<T>>&, std::span<const T>, std::span<const T>, \
                           std::span<T>);
VP_FOR_EACH_SCALAR(VP_CONFIGURATION)

}  // namespace vp
