// Semi-implicit Euler and the classical Runge-Kutta method of order 4 in Munthe-Kaas form.
//
// The state (q, v) lies on G x R^n. Within a step q = q0 [+] u, with a vector u:
//   u' = J_r^-1(u) v     Exp(u)' = Exp(u) [J_r(u) u'], which must be Exp(u) [v]
//   v' = a(q0 [+] u, v, t)
// with u(0) = 0 is a differential equation on R^2n, to which any Runge-Kutta method applies. With
// exact J_r^-1 the order is that of the method. For all joints except ball and free, J_r = 1.
// Source: Munthe-Kaas, High order Runge-Kutta methods on manifolds, Appl. Num. Math. 29 (1999).
#include "multibody/integrators.h"

#include "multibody/instantiate.h"
#include "vphysics/multibody/configuration.h"

namespace vp {
namespace detail {
namespace {

template <class T>
Vec3T<T> vector_at(std::span<const T> x, std::size_t i) {
  return {x[i], x[i + 1], x[i + 2]};
}
template <class T>
void put(const Vec3T<T>& a, std::span<T> x, std::size_t i) {
  x[i] = a.x, x[i + 1] = a.y, x[i + 2] = a.z;
}
template <class T>
bool is_less_than_a_revolution(const Vec3T<T>& w) {
  return all(dot(w, w) < T(base_t<T>(4 * kPi * kPi)));
}

}  // namespace

template <class T>
bool rate_on_group(const Tree<base_t<T>>& tree, std::span<const T> u, std::span<const T> v,
                   std::span<T> rate) {
  for (const auto& node : tree.nodes) {
    const auto i = static_cast<std::size_t>(node.v);
    if (node.kind == NodeKind::ball) {
      const Vec3T<T> w = vector_at(u, i);
      if (!is_less_than_a_revolution(w)) return false;
      put(right_jacobian_inverse(w) * vector_at(v, i), rate, i);
    } else if (node.kind == NodeKind::free) {
      const se3T<T> U{vector_at(u, i), vector_at(u, i + 3)};
      if (!is_less_than_a_revolution(U.w)) return false;
      const se3T<T> V = right_jacobian_inverse(U) * se3T<T>{vector_at(v, i), vector_at(v, i + 3)};
      put(V.w, rate, i);
      put(V.v, rate, i + 3);
    } else {
      for (std::size_t k = i; k < i + static_cast<std::size_t>(node.dofs); ++k) rate[k] = v[k];
    }
  }
  return true;
}

}  // namespace detail

template <class T>
Expected<void> step_semi_implicit(const ModelT<base_t<T>>& model, IntegratorDataT<T>& data,
                                  std::span<T> q, std::span<T> v,
                                  const std::type_identity_t<StepT<T>>& step) {
  const auto checked = detail::check_step<T>("step_semi_implicit", model, q, v, step);
  if (!checked) return checked;
  detail::IntegratorWork<T>& work = data.work();
  std::vector<T>& a = work.v_rate[0];
  const auto done = detail::acceleration<T>(model, work, q, v, step.t, step, a);
  if (!done) return done;
  for (std::size_t i = 0; i < v.size(); ++i) {
    v[i] = v[i] + T(step.h) * a[i];
    work.u[i] = T(step.h) * v[i];
  }
  integrate<T>(model, q, work.u, q);
  return {};
}

template <class T>
Expected<void> step_rk4(const ModelT<base_t<T>>& model, IntegratorDataT<T>& data, std::span<T> q,
                        std::span<T> v, const std::type_identity_t<StepT<T>>& step) {
  using B = base_t<T>;
  const auto checked = detail::check_step<T>("step_rk4", model, q, v, step);
  if (!checked) return checked;
  detail::IntegratorWork<T>& work = data.work();
  const std::size_t n = v.size();

  // Stage s is at a fraction c of the step from the start, along the rates of stage s - 1.
  constexpr double kStageFraction[4] = {0.0, 0.5, 0.5, 1.0};
  for (std::size_t s = 0; s < 4; ++s) {
    const B fraction = step.h * B(kStageFraction[s]);
    for (std::size_t i = 0; i < n; ++i) {
      work.u[i] = s == 0 ? T(0) : T(fraction) * work.u_rate[s - 1][i];
      work.v[i] = s == 0 ? v[i] : v[i] + T(fraction) * work.v_rate[s - 1][i];
    }
    integrate<T>(model, q, work.u, work.q);
    const auto done = detail::acceleration<T>(model, work, work.q, work.v, step.t + fraction, step,
                                              work.v_rate[s]);
    if (!done) return done;
    if (!detail::rate_on_group<T>(model.tree(), work.u, work.v, work.u_rate[s])) {
      return detail::invalid_argument(
          "step_rk4", "a joint turns a full turn within the step; take shorter steps");
    }
  }

  const T sixth = T(step.h / B(6));
  for (std::size_t i = 0; i < n; ++i) {
    const auto& k = work.u_rate;
    const auto& l = work.v_rate;
    work.u[i] = sixth * (k[0][i] + T(2) * (k[1][i] + k[2][i]) + k[3][i]);
    v[i] = v[i] + sixth * (l[0][i] + T(2) * (l[1][i] + l[2][i]) + l[3][i]);
  }
  integrate<T>(model, q, work.u, q);
  return {};
}

template <class T>
IntegratorDataT<T>::IntegratorDataT(const ModelT<base_t<T>>& model, Arithmetic arithmetic)
    : work_(std::make_unique<detail::IntegratorWork<T>>(model, arithmetic)) {}
template <class T>
IntegratorDataT<T>::~IntegratorDataT() = default;
template <class T>
IntegratorDataT<T>::IntegratorDataT(IntegratorDataT&&) noexcept = default;
template <class T>
IntegratorDataT<T>& IntegratorDataT<T>::operator=(IntegratorDataT&&) noexcept = default;

#define VP_INTEGRATORS(T)                                                                       \
  template bool detail::rate_on_group(const detail::Tree<base_t<T>>&, std::span<const T>,       \
                                      std::span<const T>, std::span<T>);                        \
  template class IntegratorDataT<T>;                                                            \
  template Expected<void> step_semi_implicit(const ModelT<base_t<T>>&, IntegratorDataT<T>&,     \
                                             std::span<T>, std::span<T>,                        \
                                             const std::type_identity_t<StepT<T>>&);            \
  template Expected<void> step_rk4(const ModelT<base_t<T>>&, IntegratorDataT<T>&, std::span<T>, \
                                   std::span<T>, const std::type_identity_t<StepT<T>>&);
VP_FOR_EACH_SCALAR(VP_INTEGRATORS)

}  // namespace vp
