// Mechanical quantities of a tree: the forces of M(q) a + h(q, v) = tau, where the mass is and how
// it moves, what that is worth in energy.
//
// The forces are calls like those of dynamics.h, with its preconditions. The others take up what
// forward_kinematics has left in the data, of q or, where something moves, of q and v; they are
// O(links), the matrices O(links * depth). Links that are fixed to the world count nowhere.
// Nothing is allocated. For every scalar of dynamics.h.
#pragma once

#include <span>

#include "vphysics/multibody/dynamics.h"

namespace vp {

// h(q, v): inverse dynamics at a = 0, that is Coriolis and centrifugal forces, gravity, the joints'
// damping, less what the external loads do.
template <class T>
void bias_forces(const ModelT<base_t<T>>& model, DataT<T>& data, std::span<const T> q,
                 std::span<const T> v, const LoadsT<T>& loads, std::span<T> h);
// g(q): the joint forces that hold the tree at rest against gravity [m/s^2]; the slope of
// potential_energy.
template <class T>
void gravity_forces(const ModelT<base_t<T>>& model, DataT<T>& data, std::span<const T> q,
                    const Vec3T<T>& gravity, std::span<T> g);

// [kg] of all links that can move.
template <class B>
B total_mass(const ModelT<B>& model);
// In the world. Precondition of both: the total mass is not zero.
template <class T>
Vec3T<T> centre_of_mass(const ModelT<base_t<T>>& model, const DataT<T>& data);
template <class T>
Vec3T<T> centre_of_mass_velocity(const ModelT<base_t<T>>& model, const DataT<T>& data);
// (angular about the point, linear) in the axes of the world. About {} it is the momentum at the
// world's origin, about centre_of_mass the centroidal momentum.
template <class T>
dse3T<T> momentum(const ModelT<base_t<T>>& model, const DataT<T>& data, const Vec3T<T>& about);
// 1/2 v^T M v without the joints' armature, whose motion is no link's: that adds 1/2 armature v^2
// of each.
template <class T>
T kinetic_energy(const ModelT<base_t<T>>& model, const DataT<T>& data);
// - sum of m <gravity, centre of mass>: zero where all mass is at the world's origin.
template <class T>
T potential_energy(const ModelT<base_t<T>>& model, const DataT<T>& data, const Vec3T<T>& gravity);

// A with momentum(about) = A v, 6 x velocities, column by column: about the centre of mass it is
// the centroidal momentum matrix.
template <class T>
void momentum_matrix(const ModelT<base_t<T>>& model, const DataT<T>& data, const Vec3T<T>& about,
                     std::span<dse3T<T>> A);
// J with centre_of_mass_velocity = J v, 3 x velocities, column by column.
template <class T>
void centre_of_mass_jacobian(const ModelT<base_t<T>>& model, const DataT<T>& data,
                             std::span<Vec3T<T>> J);

}  // namespace vp
