// Analytic derivatives of inverse and forward dynamics by the state.
//
// Along q a derivative is taken in the tangent space: its column k is the slope at zero of the
// result at q [+] delta (configuration.h) as delta[k] grows, the velocities held as numbers. So all
// matrices are velocities x velocities, row by row, also for ball and free joints. External loads
// are forces that turn with their link, as LoadsT has them; damping and armature are included.
//
// Inverse dynamics costs O(links * depth), forward dynamics in addition the solution for every
// column, O(velocities * links * depth). Preconditions (asserted) as in dynamics.h, matrices of the
// right size; the matrices of one call do not overlap. Nothing is allocated.
//
// Scalars as in dynamics.h. With a pack every number of the matrices is one: a call differentiates
// at as many states as it has lanes, in each lane as it does one state; of Arithmetic::reproducible
// with the same bits. A state of a pack of eight doubles takes a third to a half of the time that
// it takes alone; of a chain of a hundred joints the matrices of a pack leave the caches, and its
// states take as long as one by one.
//
// Errors: Errc::singular as forward_dynamics, in any lane; Errc::unsupported where a joint of one's
// own does not say its derivatives (UserJoint::slopes, joint.h): the velocity-product force of such
// a joint has a derivative that `evaluate` does not give. The results are then unspecified.
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

// The memory for them, of one model; used by one thread at a time, with a data of any arithmetic.
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

// Of tau(q, v, a): dtau/dq, dtau/dv, and dtau/da, which is the mass matrix.
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

// Of a(q, v, tau): da/dq, da/dv, and da/dtau, which is the inverse of the mass matrix; and a
// itself.
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
