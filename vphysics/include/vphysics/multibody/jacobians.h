// Jacobians of links and of points on them, and their time derivatives.
//
// Column k is the velocity of the link when the k-th joint velocity is one and the others are zero:
// V = J v, and V' = J a + (dJ/dt) v. Frames, with their names in Pinocchio:
//
//   link           velocity in the link's own frame, as link_velocity         LOCAL
//   world_at_link  of the link's origin, in the axes of the world              LOCAL_WORLD_ALIGNED
//   world          of the point of the link's body that is now at the          WORLD
//                  world's origin, in the axes of the world
//
// Twists are (angular, linear); Pinocchio's are (linear, angular). dJ/dt is the time derivative of
// the components of J. A point's velocity is a vector: in the link's axes for Frame::link, in the
// world's axes for the other two.
//
// The calls use the results of forward_kinematics in the data: with q for a Jacobian, with q and v
// for dJ/dt. They are O(depth of the link), except for zeroing J. Calls for dJ/dt take the same q
// and v again, because they evaluate the derivatives of user joints. Preconditions (asserted): J
// has one column for each velocity of the model; the link exists. No call allocates. Jacobians are
// for every scalar of dynamics.h, their derivatives for double and float.
//
// Errors: Errc::unsupported for dJ/dt, if a user joint with several degrees of freedom on the path
// to the link does not provide its derivatives. (dJ/dt) v is available for every joint.
#pragma once

#include <cstdint>
#include <span>

#include "vphysics/multibody/data.h"

namespace vp {

enum class Frame : std::uint8_t { link, world_at_link, world };

// J, 6 x velocities, column by column.
template <class T>
void link_jacobian(const ModelT<base_t<T>>& model, const DataT<T>& data, int link, Frame frame,
                   std::span<se3T<T>> J);
// dJ/dt.
template <class T>
Expected<void> link_jacobian_rate(const ModelT<base_t<T>>& model, const DataT<T>& data,
                                  std::span<const T> q, std::span<const T> v, int link, Frame frame,
                                  std::span<se3T<T>> J_rate);
// (dJ/dt) v, the acceleration at zero joint accelerations.
template <class T>
se3T<T> link_drift(const ModelT<base_t<T>>& model, const DataT<T>& data, std::span<const T> q,
                   std::span<const T> v, int link, Frame frame);

// The same for a point fixed to the link, given in the link's frame: 3 x velocities, column by
// column.
template <class T>
void point_jacobian(const ModelT<base_t<T>>& model, const DataT<T>& data, int link,
                    const Vec3T<T>& point, Frame frame, std::span<Vec3T<T>> J);
template <class T>
Expected<void> point_jacobian_rate(const ModelT<base_t<T>>& model, const DataT<T>& data,
                                   std::span<const T> q, std::span<const T> v, int link,
                                   const Vec3T<T>& point, Frame frame, std::span<Vec3T<T>> J_rate);
template <class T>
Vec3T<T> point_drift(const ModelT<base_t<T>>& model, const DataT<T>& data, std::span<const T> q,
                     std::span<const T> v, int link, const Vec3T<T>& point, Frame frame);

}  // namespace vp
