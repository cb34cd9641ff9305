// Mechanical quantities of a tree: the terms of M(q) a + h(q, v) = tau, centre of mass, momentum
// and energy.
//
// The force calls take q and v and have the preconditions of dynamics.h. The other calls use the
// results of forward_kinematics in the data: of q, or of q and v for velocities. They are O(links),
// the matrices O(links * depth). Links fixed to the world are not counted. No call allocates. For
// every scalar of dynamics.h.
#pragma once

#include <span>

#include "vphysics/multibody/dynamics.h"

namespace vp {

// h(q, v): inverse dynamics at a = 0. Coriolis and centrifugal forces, gravity and joint damping,
// minus the contribution of the external loads.
template <class T>
void bias_forces(const ModelT<base_t<T>>& model, DataT<T>& data, std::span<const T> q,
                 std::span<const T> v, const LoadsT<T>& loads, std::span<T> h);
// g(q): the joint forces that balance gravity [m/s^2] at rest; the gradient of potential_energy.
template <class T>
void gravity_forces(const ModelT<base_t<T>>& model, DataT<T>& data, std::span<const T> q,
                    const Vec3T<T>& gravity, std::span<T> g);

// [kg], of all links that can move.
template <class B>
B total_mass(const ModelT<B>& model);
// In the world frame. Precondition of both: the total mass is not zero.
template <class T>
Vec3T<T> centre_of_mass(const ModelT<base_t<T>>& model, const DataT<T>& data);
template <class T>
Vec3T<T> centre_of_mass_velocity(const ModelT<base_t<T>>& model, const DataT<T>& data);
// (angular about the point, linear) in the axes of the world. About {} it is the momentum at the
// world's origin, about centre_of_mass the centroidal momentum.
template <class T>
dse3T<T> momentum(const ModelT<base_t<T>>& model, const DataT<T>& data, const Vec3T<T>& about);
// 1/2 v^T M v without the joints' armature, which moves no link. Armature would add 1/2 armature
// v^2 for each velocity.
template <class T>
T kinetic_energy(const ModelT<base_t<T>>& model, const DataT<T>& data);
// - sum of m <gravity, centre of mass>: zero if all mass is at the world's origin.
template <class T>
T potential_energy(const ModelT<base_t<T>>& model, const DataT<T>& data, const Vec3T<T>& gravity);

// A with momentum(about) = A v, 6 x velocities, column by column. About the centre of mass it is
// the centroidal momentum matrix.
template <class T>
void momentum_matrix(const ModelT<base_t<T>>& model, const DataT<T>& data, const Vec3T<T>& about,
                     std::span<dse3T<T>> A);
// J with centre_of_mass_velocity = J v, 3 x velocities, column by column.
template <class T>
void centre_of_mass_jacobian(const ModelT<base_t<T>>& model, const DataT<T>& data,
                             std::span<Vec3T<T>> J);

}  // namespace vp
