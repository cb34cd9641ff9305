// The Dormand-Prince pair, orders 5 and 4, in Munthe-Kaas form (integrators.cpp), with step size
// control.
//
//   k_s = rates at (u, v) = h sum_r a_sr k_r,   x1 = h sum b_s k_s,   error = h sum e_s k_s
//   E = root of the mean square of error_i / (absolute + relative |x_i|)
//   accepted if E <= 1; then h *= 0.9 E^-(5/32) E_before^(1/16), else h *= 0.9 E^-(3/16)
//
// The last stage is at the new state, so its acceleration is the first of the next step. The
// exponents approximate those of a PI controller for order 5 (alpha = 1/5 - 3/4 beta, beta = 1/16;
// 1/5 alone after a rejected step). They are products of square roots, which give the same bits
// everywhere; pow does not.
//
// Source: Dormand, Prince, J. Comp. Appl. Math. 6 (1980); Hairer, Norsett, Wanner, Solving Ordinary
// Differential Equations I, 1993, II.4, IV.2 of volume II for the controller.
#include <algorithm>
#include <limits>

#include "multibody/integrators.h"
#include "vphysics/multibody/configuration.h"

namespace vp {
namespace detail {
namespace {

constexpr double kDormandPrinceFraction[7] = {0, 1.0 / 5, 3.0 / 10, 4.0 / 5, 8.0 / 9, 1, 1};
// Row s: the weights of stage s. The last row is also the weights of order 5.
constexpr double kDormandPrince[7][6] = {
    {},
    {1.0 / 5},
    {3.0 / 40, 9.0 / 40},
    {44.0 / 45, -56.0 / 15, 32.0 / 9},
    {19372.0 / 6561, -25360.0 / 2187, 64448.0 / 6561, -212.0 / 729},
    {9017.0 / 3168, -355.0 / 33, 46732.0 / 5247, 49.0 / 176, -5103.0 / 18656},
    {35.0 / 384, 0, 500.0 / 1113, 125.0 / 192, -2187.0 / 6784, 11.0 / 84}};
// Order 5 minus order 4.
constexpr double kDormandPrinceError[7] = {
    71.0 / 57600, 0, -71.0 / 16695, 71.0 / 1920, -17253.0 / 339200, 22.0 / 525, -1.0 / 40};

// Bounds of the change of the step size: the error estimate is valid only near its step size.
constexpr double kLargestGrowth = 5.0, kLargestShrinking = 0.2, kSafety = 0.9;

template <class B>
B sixteenth_root(B x) {
  return std::sqrt(std::sqrt(std::sqrt(std::sqrt(x))));
}

// Magnitude of the coordinate of each velocity.
template <class T>
void coordinate_scale(const Tree<T>& tree, std::span<const T> q, std::span<T> scale) {
  for (const auto& node : tree.nodes) {
    const auto i = static_cast<std::size_t>(node.v), c = static_cast<std::size_t>(node.q);
    const auto dofs = static_cast<std::size_t>(node.dofs);
    if (node.kind == NodeKind::ball || node.kind == NodeKind::free) {
      for (std::size_t k = i; k < i + 3; ++k) scale[k] = T(1);
      if (node.kind == NodeKind::ball) continue;
      const T away = norm(Vec3T<T>{q[c], q[c + 1], q[c + 2]});
      for (std::size_t k = i + 3; k < i + 6; ++k) scale[k] = away;
    } else {
      for (std::size_t k = 0; k < dofs; ++k) scale[i + k] = std::fabs(q[c + k]);
    }
  }
}

template <class T>
class DormandPrince {
 public:
  DormandPrince(const ModelT<T>& model, IntegratorWork<T>& work, const StepT<T>& step,
                const AdaptiveT<T>& options)
      : model_(model), work_(work), step_(step), options_(options) {}

  // Computes the first stage's rates at (q, v).
  Expected<void> start(std::span<const T> q, std::span<const T> v, T t) {
    std::copy(v.begin(), v.end(), work_.u_rate[0].begin());
    return acceleration<T>(model_, work_, q, v, t, step_, work_.v_rate[0]);
  }

  // Initial step: it should change the state by a hundredth of its size, both measured in
  // tolerances.
  T first_step(std::span<const T> q, std::span<const T> v) {
    coordinate_scale<T>(model_.tree(), q, work_.scale);
    T size = 0, rate = 0;
    for (std::size_t i = 0; i < v.size(); ++i) {
      const T of_q = tolerated(work_.scale[i]), of_v = tolerated(std::fabs(v[i]));
      size += square(work_.scale[i] / of_q) + square(v[i] / of_v);
      rate += square(v[i] / of_q) + square(work_.v_rate[0][i] / of_v);
    }
    if (!(size > T(0)) || !(rate > T(0))) return step_.h * T(1e-3);
    return std::min(step_.h, T(0.01) * std::sqrt(size / rate));
  }

  // Evaluates all stages. Returns E, or infinity if a stage or the new state is not valid.
  Expected<T> attempt(std::span<const T> q, std::span<const T> v, T t, T h) {
    for (std::size_t s = 1; s < kMaxStages; ++s) {
      set_stage(v, h, s);
      integrate<T>(model_, q, work_.u, work_.q);
      if (!rate_on_group<T>(model_.tree(), work_.u, work_.v, work_.u_rate[s])) return kNoState;
      if (!finite(work_.q) || !finite(work_.v)) return kNoState;
      const auto done =
          acceleration<T>(model_, work_, work_.q, work_.v, t + h * T(kDormandPrinceFraction[s]),
                          step_, work_.v_rate[s]);
      if (!done) return tl::make_unexpected(done.error());
    }
    const T E = error(q, v, h);
    return std::isfinite(E) ? E : kNoState;
  }

  // Accepts the state of the last attempt, and its rates.
  void accept(std::span<T> q, std::span<T> v) {
    std::copy(work_.q.begin(), work_.q.end(), q.begin());
    std::copy(work_.v.begin(), work_.v.end(), v.begin());
    work_.u_rate[0] = work_.v;
    work_.v_rate[0] = work_.v_rate[6];
  }

  // The growth factor of the next step.
  T factor_after_success(T E) {
    const T e = std::max(E, T(1e-4)), root = sixteenth_root(e);
    const T factor = T(kSafety) * sixteenth_root(before_) / (root * root * std::sqrt(root));
    before_ = e;
    const T max_value = rejected_ ? T(1) : T(kLargestGrowth);
    rejected_ = false;
    return std::clamp(factor, T(kLargestShrinking), max_value);
  }
  T factor_after_rejection(T E) {
    rejected_ = true;
    if (E == kNoState) return T(kLargestShrinking);
    const T root = sixteenth_root(E);
    return std::max(T(kLargestShrinking), T(kSafety) / (root * root * root));
  }

 private:
  static constexpr T kNoState = std::numeric_limits<T>::infinity();

  static T square(T x) { return x * x; }
  static bool finite(const std::vector<T>& x) {
    return std::all_of(x.begin(), x.end(), [](T y) { return std::isfinite(y); });
  }
  T tolerated(T magnitude) const { return options_.absolute + options_.relative * magnitude; }

  void set_stage(std::span<const T> v, T h, std::size_t s) {
    for (std::size_t i = 0; i < v.size(); ++i) {
      T u = 0, w = 0;
      for (std::size_t r = 0; r < s; ++r) {
        u += T(kDormandPrince[s][r]) * work_.u_rate[r][i];
        w += T(kDormandPrince[s][r]) * work_.v_rate[r][i];
      }
      work_.u[i] = h * u;
      work_.v[i] = v[i] + h * w;
    }
  }

  T error(std::span<const T> q, std::span<const T> v, T h) {
    coordinate_scale<T>(model_.tree(), q, work_.scale);
    T sum = 0;
    for (std::size_t i = 0; i < v.size(); ++i) {
      T u = 0, w = 0;
      for (std::size_t s = 0; s < kMaxStages; ++s) {
        u += T(kDormandPrinceError[s]) * work_.u_rate[s][i];
        w += T(kDormandPrinceError[s]) * work_.v_rate[s][i];
      }
      sum += square(h * u / tolerated(work_.scale[i])) +
             square(h * w / tolerated(std::max(std::fabs(v[i]), std::fabs(work_.v[i]))));
    }
    return std::sqrt(sum / static_cast<T>(2 * v.size()));
  }

  const ModelT<T>& model_;
  IntegratorWork<T>& work_;
  const StepT<T>& step_;
  const AdaptiveT<T>& options_;
  T before_ = T(1e-4);  // E of the previous step; small, so that the first step is not limited
  bool rejected_ = false;
};

template <class B>
Expected<void> check_adaptive(const AdaptiveT<B>& options) {
  const char* call = "advance_adaptive";
  if (!positive_and_finite(options.absolute) || !positive_and_finite(options.relative)) {
    return invalid_argument(call, "both tolerances must be positive and finite");
  }
  if (!(options.first_step >= B(0) && std::isfinite(options.first_step)) ||
      !(options.minimum_step >= B(0) && std::isfinite(options.minimum_step))) {
    return invalid_argument(call,
                            "first_step and minimum_step must be positive, or 0 to be chosen");
  }
  if (options.max_steps < 1) return invalid_argument(call, "max_steps must be at least 1");
  return {};
}

template <class T>
Expected<void> advance(DormandPrince<T>& method, const StepT<T>& step, const AdaptiveT<T>& options,
                       std::span<T> q, std::span<T> v, AdaptiveReportT<T>& report) {
  const T minimum = options.minimum_step > T(0) ? options.minimum_step
                                                : step.h * (sizeof(T) == 8 ? T(1e-12) : T(1e-6));
  const auto started = method.start(q, v, step.t);
  if (!started) return started;
  T h = options.first_step > T(0) ? options.first_step : method.first_step(q, v);
  h = std::max(h, minimum);
  T done = 0;  // of step.h
  while (done < step.h) {
    if (report.taken + report.refused >= options.max_steps) {
      return not_converged("advance_adaptive",
                           "max_steps are taken; allow more, or a larger tolerance");
    }
    // The last step takes all of the remaining time, even if slightly longer than h, so that no
    // tiny step remains.
    const bool last = done + T(1.01) * h >= step.h;
    const T trial = last ? step.h - done : h;
    const auto E = method.attempt(q, v, step.t + done, trial);
    if (!E) return tl::make_unexpected(E.error());
    if (*E > T(1)) {
      ++report.refused;
      h = trial * method.factor_after_rejection(*E);
      if (h < minimum) {
        return not_converged("advance_adaptive",
                             "the tolerance asks for a step below the minimum; allow a larger "
                             "error, or look whether the motion has a jump here");
      }
      continue;
    }
    method.accept(q, v);
    ++report.taken;
    done = last ? step.h : done + trial;
    report.t = step.t + done;
    if (!last) report.smallest = report.taken == 1 ? trial : std::min(report.smallest, trial);
    const T proposed = trial * method.factor_after_success(*E);
    h = std::max(last ? std::max(h, proposed) : proposed, minimum);
    report.next_step = h;
  }
  return {};
}

}  // namespace
}  // namespace detail

template <class T>
Expected<void> advance_adaptive(const ModelT<T>& model, IntegratorDataT<T>& data, std::span<T> q,
                                std::span<T> v, const std::type_identity_t<StepT<T>>& step,
                                const std::type_identity_t<AdaptiveT<T>>& options,
                                AdaptiveReportT<T>& report) {
  report = {};
  report.t = step.t;
  const auto checked = detail::check_step<T>("advance_adaptive", model, q, v, step);
  if (!checked) return checked;
  const auto sensible = detail::check_adaptive(options);
  if (!sensible) return sensible;
  detail::DormandPrince<T> method(model, data.work(), step, options);
  return detail::advance<T>(method, step, options, q, v, report);
}

#define VP_ADAPTIVE(T)                                                                          \
  template Expected<void> advance_adaptive(const ModelT<T>&, IntegratorDataT<T>&, std::span<T>, \
                                           std::span<T>, const std::type_identity_t<StepT<T>>&, \
                                           const std::type_identity_t<AdaptiveT<T>>&,           \
                                           AdaptiveReportT<T>&);
VP_ADAPTIVE(double)
VP_ADAPTIVE(float)

}  // namespace vp
