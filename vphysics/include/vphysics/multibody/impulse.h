// The response of links to impulses, from the articulated body recursion, for contact solvers.
//
//   impulse_response    dv = M^-1 J_link^T F                one impulse, all velocities, O(links)
//   inverse_inertia     L_ab = J_a M^-1 J_b^T               6x6, between two links, O(depth)
//
// J is a link's Jacobian in its own frame. F = (m, f) is an impulse on the link, about its origin
// and in its frame [N m s, N s]. The entry of the effective inverse mass between a contact row with
// wrench F_a on link a and another with F_b on link b is <F_a, L_ab F_b>. A unit impulse f at a
// point p of the link has F = (p x f, f).
//
// Precondition of all calls: the data has the factors of M, from factor_mass or from
// forward_dynamics that succeeded. No call allocates. Scalars as in dynamics.h.
//
// Source: Lilly, Efficient Dynamic Simulation of Robotic Mechanisms, 1993, section 4 (the force
// propagator); the articulated inertias are those of the paper's equation (6).
#pragma once

#include <array>
#include <vector>

#include "vphysics/multibody/data.h"

namespace vp {

// The change dv of all velocities due to the impulse F on a link.
template <class T>
void impulse_response(const ModelT<base_t<T>>& model, DataT<T>& data, int link, const dse3T<T>& F,
                      std::span<T> dv);

// A linear map from impulses on one link to velocity changes of another, each in its link's frame:
// one column for each of m.x, m.y, m.z, f.x, f.y, f.z.
template <class T>
struct ResponseT {
  std::array<se3T<T>, 6> columns;

  se3T<T> operator*(const dse3T<T>& F) const {
    return F.m.x * columns[0] + F.m.y * columns[1] + F.m.z * columns[2] + F.f.x * columns[3] +
           F.f.y * columns[4] + F.f.z * columns[5];
  }
};

// Symmetric map from impulses (m, f) to velocities: (A m + B f, B^T m + C f). 21 scalars.
template <class T>
struct InverseInertiaT {
  Sym3T<T> A;
  Mat3T<T> B{};
  Sym3T<T> C;

  se3T<T> operator*(const dse3T<T>& F) const {
    return {A * F.m + B * F.f, transposed_times(B, F.m) + C * F.f};
  }
};

// The inverse inertias of all links in one configuration. The constructor allocates. update() is
// O(links) and prepares any number of calls of inverse_inertia in this configuration.
template <class T>
class InverseInertiasT {
 public:
  explicit InverseInertiasT(const ModelT<base_t<T>>& model);
  void update(const ModelT<base_t<T>>& model, const DataT<T>& data);
  // Zero if either link is fixed to the world, or if the links belong to different roots.
  ResponseT<T> between(const ModelT<base_t<T>>& model, const DataT<T>& data, int a, int b) const;

 private:
  std::vector<InverseInertiaT<T>> of_node_;  // in the tree's frame
};

template <class T>
ResponseT<T> inverse_inertia(const ModelT<base_t<T>>& model, const DataT<T>& data,
                             const InverseInertiasT<T>& inertias, int a, int b) {
  return inertias.between(model, data, a, b);
}

using InverseInertias = InverseInertiasT<double>;
using Response = ResponseT<double>;

}  // namespace vp
