// The equations of motion of a tree:  M(q) a + h(q, v) = tau.
//
//   q    coordinates, v velocities, a their rates, tau the joint forces (joint.h)
//   M    mass matrix, h the bias force: gravity, Coriolis and centrifugal
//
// Each call is templated on the scalar: double, float, PackT<double, 4 or 8> and PackT<float, 8 or
// 16>. Preconditions: the lengths of q, v, a and tau match the model, links exist, and the data was
// made for the model (asserted); quaternions have unit length and numbers are finite (not checked:
// non-finite input gives non-finite results). Calls allocate only the text of an error.
//
// Results are those of the paper's appendix A. The passes run in one common frame instead
// (docs/decisions/0012), with its origin at the root. On a root that is not free, such as a rail or
// a planar base, the numbers grow with the root's displacement, and the rounding error with its
// square (measured: 1e-13 of the accelerations at 10 m, 6e-10 at 1 km). A FreeJoint loses no
// precision.
//
// Errors: Errc::singular if the articulated inertia of a joint is zero within rounding, in any
// lane; the results are then unspecified. In float, and for a user joint, only if it is not
// positive: rounding may leave a small positive value for a zero inertia, which gives huge
// accelerations.
#pragma once

#include <span>

#include "vphysics/multibody/data.h"

namespace vp {

// Loads on the links in addition to the joint forces.
template <class T>
struct LoadsT {
  Vec3T<T> gravity{T(0), T(0), T(-9.81)};  // [m/s^2]
  std::span<const dse3T<T>> external{};    // wrench on each link, in its frame; empty: none
};
using Loads = LoadsT<double>;

// Computes the poses of all links, and their velocities from v.
template <class T>
void forward_kinematics(const ModelT<base_t<T>>& model, DataT<T>& data, std::span<const T> q,
                        std::span<const T> v);
// The pose of a link in the world, after any call with q; the velocity of a link in its own frame,
// after any call with q and v.
template <class T>
SE3T<T> T_world_link(const ModelT<base_t<T>>& model, const DataT<T>& data, int link);
template <class T>
se3T<T> link_velocity(const ModelT<base_t<T>>& model, const DataT<T>& data, int link);

// Computes a from tau by the articulated body algorithm, O(links).
template <class T>
Expected<void> forward_dynamics(const ModelT<base_t<T>>& model, DataT<T>& data,
                                std::span<const T> q, std::span<const T> v, std::span<const T> tau,
                                const LoadsT<T>& loads, std::span<T> a);
// factor_mass factors M by the articulated body algorithm, O(links). solve_mass replaces x by M^-1
// x, O(links), with the factors in the data from factor_mass or forward_dynamics: the velocity
// change due to joint impulses x. No call with another q may come in between.
template <class T>
Expected<void> factor_mass(const ModelT<base_t<T>>& model, DataT<T>& data, std::span<const T> q);
template <class T>
void solve_mass(const ModelT<base_t<T>>& model, DataT<T>& data, std::span<T> x);
// Computes tau from a by the recursive Newton-Euler algorithm, O(links).
template <class T>
void inverse_dynamics(const ModelT<base_t<T>>& model, DataT<T>& data, std::span<const T> q,
                      std::span<const T> v, std::span<const T> a, const LoadsT<T>& loads,
                      std::span<T> tau);
// Computes M, velocities x velocities, row by row, by the composite rigid body algorithm, O(links *
// depth).
template <class T>
void mass_matrix(const ModelT<base_t<T>>& model, DataT<T>& data, std::span<const T> q,
                 std::span<T> M);

}  // namespace vp
