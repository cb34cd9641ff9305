// Time integration of a tree on its configuration manifold.
//
// Coordinates of ball and free joints are updated on the group (configuration.h: q [+] delta), not
// by adding quaternion rates. Quaternions therefore keep unit length without a projection.
//
//   step_semi_implicit   order 1, symplectic where M is constant; one forward dynamics a step
//   step_rk4             order 4, Runge-Kutta-Munthe-Kaas; four a step
//   advance_adaptive     order 5 with an error estimate of order 4: Dormand-Prince in Munthe-Kaas
//                        form; over any duration, with its own step sizes
//   step_variational     order 2, symplectic and time-reversible: energy does not drift, momentum
//                        is conserved to rounding; costs 5 (one body) to 16 (whipping chain) times
//                        the first
//
// docs/decisions/0016 compares them and says which to use. q and v are updated in place. When a
// call fails, they are unchanged (advance_adaptive: they are the state at report.t). A step does
// not allocate.
//
// Preconditions: the lengths of q, v and the forces match the model (asserted); the state and the
// forces are finite, quaternions have unit length, and the data was made for the model. Errors:
// Errc::invalid_argument for a step, duration or tolerance that is not positive and finite;
// Errc::singular as in forward_dynamics (dynamics.h); Errc::not_converged where stated.
#pragma once

#include <concepts>
#include <memory>
#include <span>
#include <type_traits>

#include "vphysics/multibody/dynamics.h"

namespace vp {

namespace detail {
template <class T>
struct IntegratorWork;
}

// Working memory of a step, with a data (dynamics.h). Used by one thread at a time.
template <class T>
class IntegratorDataT {
 public:
  explicit IntegratorDataT(const ModelT<base_t<T>>& model,
                           Arithmetic arithmetic = Arithmetic::fastest);
  ~IntegratorDataT();
  IntegratorDataT(IntegratorDataT&&) noexcept;
  IntegratorDataT& operator=(IntegratorDataT&&) noexcept;

  detail::IntegratorWork<T>& work() { return *work_; }

 private:
  std::unique_ptr<detail::IntegratorWork<T>> work_;
};
using IntegratorData = IntegratorDataT<double>;

// The joint forces tau over a step: none, constant, or computed by forces(q, v, t, tau), which
// writes tau. This object only refers to them: they must outlive the call.
template <class T>
class JointForcesT {
 public:
  using Time = base_t<T>;

  JointForcesT() = default;
  template <std::convertible_to<std::span<const T>> Numbers>
  JointForcesT(const Numbers& constant) : constant_(constant) {}
  template <class F>
  requires(std::is_object_v<F>&&
               std::invocable<const F&, std::span<const T>, std::span<const T>, Time, std::span<T>>)
      JointForcesT(const F& forces)
      : object_(&forces),
        call_([](const void* object, std::span<const T> q, std::span<const T> v, Time t,
                 std::span<T> tau) { (*static_cast<const F*>(object))(q, v, t, tau); }) {}

  // tau at a state: the constant, or scratch after the forces were written there.
  std::span<const T> at(std::span<const T> q, std::span<const T> v, Time t,
                        std::span<T> scratch) const {
    if (call_ != nullptr) {
      call_(object_, q, v, t, scratch);
      return scratch;
    }
    if (!constant_.empty()) return constant_;
    for (T& x : scratch) x = T(0);
    return scratch;
  }
  // Checks the length of a constant; empty and computed forces always fit.
  bool fits(std::size_t velocities) const {
    return constant_.empty() || constant_.size() == velocities;
  }

 private:
  using Call = void (*)(const void*, std::span<const T>, std::span<const T>, Time, std::span<T>);
  std::span<const T> constant_;
  const void* object_ = nullptr;
  Call call_ = nullptr;
};

// The time interval and the forces of a step. The lanes of a pack share t and h.
template <class T>
struct StepT {
  base_t<T> h{};  // > 0 [s]
  base_t<T> t{};  // at the beginning; only used by the forces
  JointForcesT<T> forces{};
  LoadsT<T> loads{};
};

// v += h a(q, v), q = q [+] h v. For all scalars of dynamics.h.
template <class T>
Expected<void> step_semi_implicit(const ModelT<base_t<T>>& model, IntegratorDataT<T>& data,
                                  std::span<T> q, std::span<T> v,
                                  const std::type_identity_t<StepT<T>>& step);
// For all scalars of dynamics.h. Fails also if a ball or free joint makes a full revolution within
// the step.
template <class T>
Expected<void> step_rk4(const ModelT<base_t<T>>& model, IntegratorDataT<T>& data, std::span<T> q,
                        std::span<T> v, const std::type_identity_t<StepT<T>>& step);

// The tolerance for the error of x is absolute + relative |x|. The error norm is the root mean
// square over all coordinates and velocities. An angle of a ball or free joint counts as 1 rad.
template <class B>
struct AdaptiveT {
  B absolute = B(1e-9), relative = B(1e-9);
  B first_step = B(0);    // 0: chosen from the first rates
  B minimum_step = B(0);  // 0: 1e-12 of the duration (float: 1e-6)
  long max_steps = 10'000'000;
};
template <class B>
struct AdaptiveReportT {
  B t{};                      // time reached
  long taken = 0;             // accepted steps
  long refused = 0;           // rejected steps: error too large
  B next_step{}, smallest{};  // proposal for the next call; smallest accepted, without the last
};
using Adaptive = AdaptiveT<double>;
using AdaptiveReport = AdaptiveReportT<double>;

// Integrates over step.h with its own step sizes. For double and float. Errc::not_converged: the
// tolerance requires a step below the minimum, or more than max_steps; report says how far it got.
template <class T>
Expected<void> advance_adaptive(const ModelT<T>& model, IntegratorDataT<T>& data, std::span<T> q,
                                std::span<T> v, const std::type_identity_t<StepT<T>>& step,
                                const std::type_identity_t<AdaptiveT<T>>& options,
                                AdaptiveReportT<T>& report);

// The iteration ends when the kinetic energy of a correction is below tolerance^2 of the tree's
// kinetic energy, or at the level of rounding. That correction is still applied.
template <class B>
struct VariationalT {
  B tolerance = sizeof(B) == 8 ? B(1e-14) : B(1e-6);  // relative, of velocities
  int max_iterations = 50;
};
using Variational = VariationalT<double>;

// Returns the number of iterations. The forces are evaluated at both ends of the step with the mean
// velocity of the step, also in each iteration. For double and float. Errc::not_converged: the step
// is too long for the rotation of a link (at most pi) or for a stiff damper (h damping / (2 M) < 1
// is required).
template <class T>
Expected<int> step_variational(const ModelT<T>& model, IntegratorDataT<T>& data, std::span<T> q,
                               std::span<T> v, const std::type_identity_t<StepT<T>>& step,
                               const std::type_identity_t<VariationalT<T>>& options = {});

}  // namespace vp
