// From one state of a tree to a later one, on its configuration manifold.
//
// Coordinates of ball and free joints are moved by the group (configuration.h: q [+] delta), never
// by adding rates of quaternions, so that they stay of unit length without a projection.
//
//   step_semi_implicit   order 1, symplectic where M is constant; one forward dynamics a step
//   step_rk4             order 4, Runge-Kutta-Munthe-Kaas; four a step
//   advance_adaptive     order 5 with an error of order 4: Dormand-Prince in Munthe-Kaas form; over
//                        any duration, in steps of its own
//   step_variational     order 2, symplectic and time-reversible: energy does not drift, momentum
//   is
//                        kept to rounding; costs 5 (one body) to 16 (whipping chain) of the first
//
// docs/decisions/0016 says which is for what. q and v are stepped in place; when a call fails they
// are as they were (advance_adaptive: as they were at report.t). Nothing is allocated in a step.
//
// Preconditions: the lengths of q, v and the forces are the model's (asserted), the state and the
// forces are finite, quaternions of unit length, and the data was made for the model.
// Errors: Errc::invalid_argument for a step, duration or tolerance that is not positive and finite;
// Errc::singular as forward_dynamics (dynamics.h); Errc::not_converged where said.
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

// The memory of a step, and a data (dynamics.h) within it. One thread at a time.
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

// The joints' forces tau over a step: none, constant, or what forces(q, v, t, tau) writes into tau.
// It only refers to them: they must outlive the call that they are given to.
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

  // tau at a state: the constant, or scratch with what was written there.
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
  // Of the constant; none and what is called always fit.
  bool fits(std::size_t velocities) const {
    return constant_.empty() || constant_.size() == velocities;
  }

 private:
  using Call = void (*)(const void*, std::span<const T>, std::span<const T>, Time, std::span<T>);
  std::span<const T> constant_;
  const void* object_ = nullptr;
  Call call_ = nullptr;
};

// Over which time, and what acts. Packs share t and h.
template <class T>
struct StepT {
  base_t<T> h{};  // > 0 [s]
  base_t<T> t{};  // at the beginning; only the forces see it
  JointForcesT<T> forces{};
  LoadsT<T> loads{};
};

// v += h a(q, v), q = q [+] h v. For all scalars of dynamics.h.
template <class T>
Expected<void> step_semi_implicit(const ModelT<base_t<T>>& model, IntegratorDataT<T>& data,
                                  std::span<T> q, std::span<T> v,
                                  const std::type_identity_t<StepT<T>>& step);
// For all scalars of dynamics.h. Refused too: a ball or free joint that turns a full turn within
// the step.
template <class T>
Expected<void> step_rk4(const ModelT<base_t<T>>& model, IntegratorDataT<T>& data, std::span<T> q,
                        std::span<T> v, const std::type_identity_t<StepT<T>>& step);

// An error of x is tolerated up to absolute + relative |x|, in the root of the mean square over all
// coordinates and velocities; an angle of a ball or free joint counts as 1 rad.
template <class B>
struct AdaptiveT {
  B absolute = B(1e-9), relative = B(1e-9);
  B first_step = B(0);    // 0: found from the first rates
  B minimum_step = B(0);  // 0: 1e-12 of the duration (float: 1e-6)
  long max_steps = 10'000'000;
};
template <class B>
struct AdaptiveReportT {
  B t{};                      // reached
  long taken = 0;             // steps
  long refused = 0;           // trials whose error was too large
  B next_step{}, smallest{};  // proposed to go on with; of those taken, but the last
};
using Adaptive = AdaptiveT<double>;
using AdaptiveReport = AdaptiveReportT<double>;

// Over all of step.h, in steps of its own. For double and float. Errc::not_converged: the tolerance
// asks for a step below the minimum, or for more than max_steps; report says how far it came.
template <class T>
Expected<void> advance_adaptive(const ModelT<T>& model, IntegratorDataT<T>& data, std::span<T> q,
                                std::span<T> v, const std::type_identity_t<StepT<T>>& step,
                                const std::type_identity_t<AdaptiveT<T>>& options,
                                AdaptiveReportT<T>& report);

// The step's equation is solved until the kinetic energy of a correction is below tolerance^2 of
// the tree's own, or as small as rounding lets it be, and that correction is still made.
template <class B>
struct VariationalT {
  B tolerance = sizeof(B) == 8 ? B(1e-14) : B(1e-6);  // of velocities
  int max_iterations = 50;
};
using Variational = VariationalT<double>;

// How often the step's equation was corrected. The forces are evaluated at both ends of the step
// with the mean velocity of the step, also while iterating. For double and float.
// Errc::not_converged: the step is too long, for how fast a link turns (at most half a turn) or for
// a damper that is too stiff (h damping / (2 M) < 1).
template <class T>
Expected<int> step_variational(const ModelT<T>& model, IntegratorDataT<T>& data, std::span<T> q,
                               std::span<T> v, const std::type_identity_t<StepT<T>>& step,
                               const std::type_identity_t<VariationalT<T>>& options = {});

}  // namespace vp
