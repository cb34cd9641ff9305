// The equations of motion of a tree:  M(q) a + h(q, v) = tau.
//
//   q    coordinates, v velocities, a their rates, tau the joints' forces (joint.h)
//   M    mass matrix, h the bias force: gravity, Coriolis and centrifugal
//
// Each call is templated on the scalar: double, float, PackT<double, 4 or 8> and PackT<float, 8 or
// 16>. Preconditions: the lengths of q, v, a and tau are those of the model, links are its own, the
// data was made for it (asserted); quaternions are of unit length, numbers are finite (not looked
// at: what is not finite gives results that are not). Nothing is allocated but the text of an
// error. Results are those of the paper's appendix A; the passes run in one common frame instead
// (docs/decisions/0012), with its origin at the root: on a root that is not free, such as a rail or
// a planar base, the numbers grow with the way it has gone, and what is lost of them with its
// square (measured: 1e-13 of the accelerations at 10 m, 6e-10 at 1 km). A FreeJoint loses nothing.
//
// Errors: Errc::singular where the articulated inertia of a joint is nothing but rounding, in any
// lane; the results are then unspecified. In float, and of a user's joint, only where it is not
// positive: rounding may leave a positive one of nothing, and then enormous accelerations.
#pragma once

#include <span>

#include "vphysics/multibody/data.h"

namespace vp {

// What acts on the links besides the joints.
template <class T>
struct LoadsT {
  Vec3T<T> gravity{T(0), T(0), T(-9.81)};  // [m/s^2]
  std::span<const dse3T<T>> external{};    // of each link, in its frame; empty: none
};
using Loads = LoadsT<double>;

// Poses of all links, and their velocities with v.
template <class T>
void forward_kinematics(const ModelT<base_t<T>>& model, DataT<T>& data, std::span<const T> q,
                        std::span<const T> v);
// After any call that was given q: the pose of a link in the world, and where v was given too its
// velocity in its own frame.
template <class T>
SE3T<T> T_world_link(const ModelT<base_t<T>>& model, const DataT<T>& data, int link);
template <class T>
se3T<T> link_velocity(const ModelT<base_t<T>>& model, const DataT<T>& data, int link);

// a from tau: the articulated body algorithm, O(links).
template <class T>
Expected<void> forward_dynamics(const ModelT<base_t<T>>& model, DataT<T>& data,
                                std::span<const T> q, std::span<const T> v, std::span<const T> tau,
                                const LoadsT<T>& loads, std::span<T> a);
// M in factors, by the articulated body algorithm, O(links), and x <- M^-1 x with the factors that
// the data has, from this call or from forward_dynamics, O(links) too: the response of the
// velocities to joint impulses x. In between no other q is given to the data.
template <class T>
Expected<void> factor_mass(const ModelT<base_t<T>>& model, DataT<T>& data, std::span<const T> q);
template <class T>
void solve_mass(const ModelT<base_t<T>>& model, DataT<T>& data, std::span<T> x);
// tau from a: the recursive Newton-Euler algorithm, O(links).
template <class T>
void inverse_dynamics(const ModelT<base_t<T>>& model, DataT<T>& data, std::span<const T> q,
                      std::span<const T> v, std::span<const T> a, const LoadsT<T>& loads,
                      std::span<T> tau);
// M, velocities x velocities, row by row: the composite body algorithm, O(links * depth).
template <class T>
void mass_matrix(const ModelT<base_t<T>>& model, DataT<T>& data, std::span<const T> q,
                 std::span<T> M);

}  // namespace vp
