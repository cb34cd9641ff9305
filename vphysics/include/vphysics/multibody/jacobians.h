// Jacobians of links and of points on them, and their rates.
//
// Column k is the velocity of the link while the k-th joint velocity alone is one: V = J v, and
// V' = J a + (dJ/dt) v. Frames, with their names in Pinocchio:
//
//   link           the velocity in the link's own frame, as link_velocity     LOCAL
//   world_at_link  of the link's origin, in the axes of the world              LOCAL_WORLD_ALIGNED
//   world          of the point of the link's body that is now at the          WORLD
//                  world's origin, in the axes of the world
//
// Twists are (angular, linear); Pinocchio's are (linear, angular). A rate is the derivative of J's
// numbers by time. A point's velocity is a vector: link has it in the link's axes, both others in
// those of the world.
//
// The calls take up what forward_kinematics has left in the data: with q for a Jacobian, with q and
// v for a rate, and are O(depth of the link) but for zeroing J. The rates are handed the same q and
// v again, because a joint of one's own is asked for its slopes at them. Preconditions (asserted):
// J has a column for each velocity of the model, the link exists. Nothing is allocated. Jacobians
// are for every scalar of dynamics.h, rates for double and float.
//
// Errors: Errc::unsupported of a whole rate, where on the way to the link a joint of one's own with
// several degrees does not say its slopes; (dJ/dt) v is known for every joint.
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
// (dJ/dt) v, the acceleration that the velocities alone make.
template <class T>
se3T<T> link_drift(const ModelT<base_t<T>>& model, const DataT<T>& data, std::span<const T> q,
                   std::span<const T> v, int link, Frame frame);

// The same of a point that is fixed to the link, given in the link's frame: 3 x velocities, column
// by column.
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
