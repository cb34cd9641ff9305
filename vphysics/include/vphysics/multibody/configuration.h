// Integrates and differences configurations of a tree, joint by joint.
//
// The coordinates of a ball and of a free joint contain a quaternion, so configurations cannot be
// added or subtracted as vectors. A tangent vector delta has the length of the velocities and is
// expressed in the link's own frame:
//
//   q [+] delta   simple and user joints: q + delta
//                 ball: R Exp(delta); free: T Exp(delta), delta = (angular, linear)
//   q1 [-] q0     the delta with q0 [+] delta = q1, along the shorter rotation
//
// The derivatives (derivatives.h) use such tangent vectors. delta = h v is a step of duration h at
// velocity v. Pinocchio uses the same names, integrate and difference. Templated on the scalar, as
// dynamics.h. No call allocates. Preconditions (asserted): the lengths match the model; quaternions
// are not zero.
#pragma once

#include <span>

#include "vphysics/multibody/model.h"

namespace vp {

// out = q [+] delta. Quaternions in out have unit length to rounding, and their sign does not jump.
// out may be q.
template <class T>
void integrate(const ModelT<base_t<T>>& model, std::span<const T> q, std::span<const T> delta,
               std::span<T> out);
// delta = q1 [-] q0. At a rotation by exactly pi, either of the two equally short rotations.
template <class T>
void difference(const ModelT<base_t<T>>& model, std::span<const T> q0, std::span<const T> q1,
                std::span<T> delta);

}  // namespace vp
