// Sums over the nodes, each body in its tree's frame (work.h):
//
//   momentum       sum of J_i V_i, moved from the tree's origin to the requested point
//   its matrix     A_k = sum over the nodes i that joint k moves of J_i S_k
//   energies       1/2 sum <V_i, J_i V_i>,  - sum m_i <g, c_i>
#include "vphysics/multibody/quantities.h"

#include <algorithm>

#include "multibody/instantiate.h"
#include "multibody/kinematics.h"
#include "vphysics/assert.h"

namespace vp {
namespace detail {
namespace {

// Moves a momentum from the tree's origin to another point.
template <class T>
dse3T<T> moved_to(const dse3T<T>& F, const Vec3T<T>& tree_origin, const Vec3T<T>& about) {
  return {F.m + cross(tree_origin - about, F.f), F.f};
}

// Calls f(node index, its body's inertia in the tree's frame) for each node.
template <class T, class F>
void for_each_body(const Tree<base_t<T>>& tree, const Work<T>& work, const F& f) {
  for (std::size_t i = 0; i < tree.nodes.size(); ++i) {
    const int node = static_cast<int>(i);
    if (tree.nodes[i].J != InertiaT<base_t<T>>{}) f(node, inertia_of(tree, work, node));
  }
}
// Calls f(velocity index, S) for each velocity that moves the node.
template <class T, class F>
void for_each_ancestor_column(const Tree<base_t<T>>& tree, const Work<T>& work, int node,
                              const F& f) {
  for (int i = node; i != kWorld; i = tree.nodes[static_cast<std::size_t>(i)].parent) {
    const auto& mover = tree.nodes[static_cast<std::size_t>(i)];
    for (int k = 0; k < mover.dofs; ++k) {
      const int velocity = mover.v + k;
      f(static_cast<std::size_t>(velocity), column_of(tree, work, i, k));
    }
  }
}

template <class T>
dse3T<T> momentum_about(const Tree<base_t<T>>& tree, const Work<T>& work, const Vec3T<T>& about) {
  dse3T<T> sum{};
  for_each_body<T>(tree, work, [&](int node, const InertiaT<T>& J) {
    sum = sum + moved_to(J * velocity_of(work, node), origin_of(work, node), about);
  });
  return sum;
}

template <class T>
Vec3T<T> first_moment(const Tree<base_t<T>>& tree, const Work<T>& work) {
  Vec3T<T> sum{};
  for_each_body<T>(tree, work, [&](int node, const InertiaT<T>& J) {
    sum += J.first_moment() + J.mass() * origin_of(work, node);
  });
  return sum;
}

}  // namespace
}  // namespace detail

template <class T>
void bias_forces(const ModelT<base_t<T>>& model, DataT<T>& data, std::span<const T> q,
                 std::span<const T> v, const LoadsT<T>& loads, std::span<T> h) {
  inverse_dynamics<T>(model, data, q, v, data.work().zeros, loads, h);
}
template <class T>
void gravity_forces(const ModelT<base_t<T>>& model, DataT<T>& data, std::span<const T> q,
                    const Vec3T<T>& gravity, std::span<T> g) {
  const std::vector<T>& zeros = data.work().zeros;
  inverse_dynamics<T>(model, data, q, zeros, zeros, {.gravity = gravity}, g);
}

template <class B>
B total_mass(const ModelT<B>& model) {
  B mass(0);
  for (const auto& node : model.tree().nodes) mass += node.J.mass();
  return mass;
}
template <class T>
Vec3T<T> centre_of_mass(const ModelT<base_t<T>>& model, const DataT<T>& data) {
  return (T(1) / T(total_mass(model))) * detail::first_moment<T>(model.tree(), data.work());
}
template <class T>
Vec3T<T> centre_of_mass_velocity(const ModelT<base_t<T>>& model, const DataT<T>& data) {
  return (T(1) / T(total_mass(model))) * momentum<T>(model, data, {}).f;
}
template <class T>
dse3T<T> momentum(const ModelT<base_t<T>>& model, const DataT<T>& data, const Vec3T<T>& about) {
  return detail::momentum_about<T>(model.tree(), data.work(), about);
}
template <class T>
T kinetic_energy(const ModelT<base_t<T>>& model, const DataT<T>& data) {
  T twice(0);
  detail::for_each_body<T>(model.tree(), data.work(), [&](int node, const InertiaT<T>& J) {
    const se3T<T> V = velocity_of(data.work(), node);
    twice += V * (J * V);
  });
  return T(0.5) * twice;
}
template <class T>
T potential_energy(const ModelT<base_t<T>>& model, const DataT<T>& data, const Vec3T<T>& gravity) {
  return -dot(gravity, detail::first_moment<T>(model.tree(), data.work()));
}

template <class T>
void momentum_matrix(const ModelT<base_t<T>>& model, const DataT<T>& data, const Vec3T<T>& about,
                     std::span<dse3T<T>> A) {
  const auto& tree = model.tree();
  const auto& work = data.work();
  VP_ASSERT(A.size() == static_cast<std::size_t>(tree.velocities));
  std::fill(A.begin(), A.end(), dse3T<T>{});
  detail::for_each_body<T>(tree, work, [&](int node, const InertiaT<T>& J) {
    const Vec3T<T> origin = origin_of(work, node);
    detail::for_each_ancestor_column<T>(tree, work, node, [&](std::size_t k, const se3T<T>& S) {
      A[k] = A[k] + detail::moved_to(J * S, origin, about);
    });
  });
}
template <class T>
void centre_of_mass_jacobian(const ModelT<base_t<T>>& model, const DataT<T>& data,
                             std::span<Vec3T<T>> J) {
  const auto& tree = model.tree();
  const auto& work = data.work();
  VP_ASSERT(J.size() == static_cast<std::size_t>(tree.velocities));
  std::fill(J.begin(), J.end(), Vec3T<T>{});
  const T fraction = T(1) / T(total_mass(model));
  detail::for_each_body<T>(tree, work, [&](int node, const InertiaT<T>& body) {
    detail::for_each_ancestor_column<T>(tree, work, node, [&](std::size_t k, const se3T<T>& S) {
      J[k] += fraction * (body.mass() * S.v + cross(S.w, body.first_moment()));
    });
  });
}

#ifndef VP_PACKS
template double total_mass(const ModelT<double>&);
template float total_mass(const ModelT<float>&);
#endif

#define VP_QUANTITIES(T)                                                                    \
  template void bias_forces(const ModelT<base_t<T>>&, DataT<T>&, std::span<const T>,        \
                            std::span<const T>, const LoadsT<T>&, std::span<T>);            \
  template void gravity_forces(const ModelT<base_t<T>>&, DataT<T>&, std::span<const T>,     \
                               const Vec3T<T>&, std::span<T>);                              \
  template Vec3T<T> centre_of_mass(const ModelT<base_t<T>>&, const DataT<T>&);              \
  template Vec3T<T> centre_of_mass_velocity(const ModelT<base_t<T>>&, const DataT<T>&);     \
  template dse3T<T> momentum(const ModelT<base_t<T>>&, const DataT<T>&, const Vec3T<T>&);   \
  template T kinetic_energy(const ModelT<base_t<T>>&, const DataT<T>&);                     \
  template T potential_energy(const ModelT<base_t<T>>&, const DataT<T>&, const Vec3T<T>&);  \
  template void momentum_matrix(const ModelT<base_t<T>>&, const DataT<T>&, const Vec3T<T>&, \
                                std::span<dse3T<T>>);                                       \
  template void centre_of_mass_jacobian(const ModelT<base_t<T>>&, const DataT<T>&,          \
                                        std::span<Vec3T<T>>);
VP_FOR_EACH_SCALAR(VP_QUANTITIES)

}  // namespace vp
