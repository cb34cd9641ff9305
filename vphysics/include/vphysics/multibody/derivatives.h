// Analytic derivatives of inverse and forward dynamics with respect to the state.
//
// Derivatives with respect to q are taken in the tangent space: column k is the derivative at zero
// of the result at q [+] delta (configuration.h) with respect to delta[k], with the components of v
// constant. All matrices are therefore velocities x velocities, row by row, also for ball and free
// joints. External loads rotate with their link, as in LoadsT. Damping and armature are included.
//
// Inverse dynamics costs O(links * depth). Forward dynamics in addition solves for every column,
// O(velocities * links * depth). Preconditions (asserted): as in dynamics.h; matrices have the
// right size, and the matrices of one call do not overlap. No call allocates.
//
// Scalars as in dynamics.h. With a pack, every number of the matrices is a pack: one call
// differentiates at one state for each SIMD lane. With Arithmetic::reproducible each lane has the
// same bits as a single state. In a pack of eight doubles, a state takes a third to a half of the
// time of a single state. For a chain of a hundred joints the matrices of a pack exceed the caches,
// and a pack saves no time.
//
// Errors: Errc::singular as in forward_dynamics, in any lane; Errc::unsupported if a user joint
// does not provide its derivatives (UserJoint::subspace_derivatives, joint.h), because `evaluate`
// does not give the derivative of its velocity-product force. The results are then unspecified.
//
// Source: Carpentier, Mansard, Analytical derivatives of rigid body dynamics algorithms, RSS 2018;
// Singh, Russo, Wensing, Efficient analytical derivatives of rigid-body dynamics using spatial
// vector algebra, RA-L 2022.
#pragma once

#include <memory>
#include <span>

#include "vphysics/multibody/dynamics.h"

namespace vp {

namespace detail {
template <class T>
struct DerivativesWork;
}

// Working memory of the derivatives of one model. Used by one thread at a time, with a data of
// either Arithmetic.
template <class T>
class DerivativesDataT {
 public:
  explicit DerivativesDataT(const ModelT<base_t<T>>& model);
  ~DerivativesDataT();
  DerivativesDataT(DerivativesDataT&&) noexcept;
  DerivativesDataT& operator=(DerivativesDataT&&) noexcept;

  detail::DerivativesWork<T>& work() { return *work_; }

 private:
  std::unique_ptr<detail::DerivativesWork<T>> work_;
};
using DerivativesData = DerivativesDataT<double>;

// Derivatives of tau(q, v, a): dtau/dq, dtau/dv, and dtau/da, which is the mass matrix.
template <class T>
struct InverseDerivativesT {
  std::span<T> tau_q, tau_v, tau_a;
};
template <class T>
Expected<void> inverse_dynamics_derivatives(const ModelT<base_t<T>>& model, DataT<T>& data,
                                            DerivativesDataT<T>& memory, std::span<const T> q,
                                            std::span<const T> v, std::span<const T> a,
                                            const LoadsT<T>& loads,
                                            const InverseDerivativesT<T>& out);

// a(q, v, tau) and its derivatives: da/dq, da/dv, and da/dtau, which is the inverse of the mass
// matrix.
template <class T>
struct ForwardDerivativesT {
  std::span<T> a;
  std::span<T> a_q, a_v, a_tau;
};
template <class T>
Expected<void> forward_dynamics_derivatives(const ModelT<base_t<T>>& model, DataT<T>& data,
                                            DerivativesDataT<T>& memory, std::span<const T> q,
                                            std::span<const T> v, std::span<const T> tau,
                                            const LoadsT<T>& loads,
                                            const ForwardDerivativesT<T>& out);

}  // namespace vp
