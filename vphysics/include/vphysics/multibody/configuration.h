// Steps between configurations of a tree, joint by joint.
//
// The coordinates of a ball and a free joint hold a quaternion, so two configurations are neither
// added nor subtracted. A step delta has the length of the velocities and is taken in the link's
// own frame:
//
//   q [+] delta   every simple and user's joint: q + delta
//                 ball: R Exp(delta); free: T Exp(delta), delta = (angular, linear)
//   q1 [-] q0     the delta with q0 [+] delta = q1, turning the shorter way
//
// A tangent vector of the derivatives (derivatives.h) is such a delta; delta = h v is a step of
// duration h at velocities v. Pinocchio has the same names. Templated on the scalar as dynamics.h;
// nothing is allocated. Preconditions (asserted): the lengths are the model's; quaternions are not
// zero.
#pragma once

#include <span>

#include "vphysics/multibody/model.h"

namespace vp {

// out = q [+] delta, with quaternions of unit length to rounding and without a jump of their sign.
// out may be q.
template <class T>
void integrate(const ModelT<base_t<T>>& model, std::span<const T> q, std::span<const T> delta,
               std::span<T> out);
// delta = q1 [-] q0; at a half turn exactly, of the two shorter ways one.
template <class T>
void difference(const ModelT<base_t<T>>& model, std::span<const T> q0, std::span<const T> q1,
                std::span<T> delta);

}  // namespace vp
