// The derivatives of a user joint, in any scalar; lane by lane for a pack of states.
#pragma once

#include <array>

#include "multibody/joints.h"

namespace vp::detail {

// For n degrees of freedom, in the link's frame.
template <class T>
struct UserDerivatives {
  std::array<se3T<T>, 36> S{};    // dS[k]/dq[l] at [n * k + l]
  std::array<se3T<T>, 6> rate{};  // d rate/dq[l]
};

template <class T>
se3T<T> cast_twist(const se3& V) {
  const auto each = [](const Vec3& a) {
    return Vec3T<T>{static_cast<T>(a.x), static_cast<T>(a.y), static_cast<T>(a.z)};
  };
  return {each(V.w), each(V.v)};
}

// The joint's coordinates and velocities in one lane, in double.
struct UserState {
  std::array<double, 6> q{}, v{};
  std::size_t n;

  template <class T>
  UserState(const Node<base_t<T>>& node, std::span<const T> all_q, std::span<const T> all_v,
            int lane = 0)
      : n(static_cast<std::size_t>(node.dofs)) {
    for (std::size_t k = 0; k < n; ++k) {
      q[k] = lane_of(all_q[static_cast<std::size_t>(node.q) + k], lane);
      v[k] = lane_of(all_v[static_cast<std::size_t>(node.v) + k], lane);
    }
  }
  std::span<const double> coordinates() const { return std::span(q).first(n); }
  std::span<const double> velocities() const { return std::span(v).first(n); }
};

// Evaluates one lane. Returns false if the joint does not provide its derivatives.
template <class T>
bool user_derivatives(const Node<base_t<T>>& node, const UserState& at, int lane,
                      UserDerivatives<T>& out) {
  UserDerivatives<double> found;
  if (!node.user->subspace_derivatives(at.coordinates(), at.velocities(),
                                       std::span(found.S).first(at.n * at.n),
                                       std::span(found.rate).first(at.n))) {
    return false;
  }
  for (std::size_t i = 0; i < at.n * at.n; ++i) set_lane(out.S[i], lane, found.S[i]);
  for (std::size_t i = 0; i < at.n; ++i) set_lane(out.rate[i], lane, found.rate[i]);
  return true;
}

// (dS/dt) v
template <class T>
se3T<T> user_rate(const Node<T>& node, const UserState& at) {
  SE3 pose;
  std::array<se3, 6> S{};
  se3 rate;
  node.user->evaluate(at.coordinates(), at.velocities(), pose, std::span(S).first(at.n), rate);
  return cast_twist<T>(rate);
}

// The rates of the columns: sum over l of dS[k]/dq[l] v[l]. With one degree of freedom, evaluate's
// rate at unit velocity is dS/dq.
template <class T>
bool user_column_rates(const Node<T>& node, const UserState& at, std::array<se3T<T>, 6>& rates) {
  if (at.n == 1) {
    UserState unit = at;
    unit.v[0] = 1.0;
    rates[0] = static_cast<T>(at.v[0]) * user_rate(node, unit);
    return true;
  }
  UserDerivatives<T> derivatives;
  if (!user_derivatives<T>(node, at, 0, derivatives)) return false;
  for (std::size_t k = 0; k < at.n; ++k) {
    rates[k] = {};
    for (std::size_t l = 0; l < at.n; ++l) {
      rates[k] = rates[k] + static_cast<T>(at.v[l]) * derivatives.S[at.n * k + l];
    }
  }
  return true;
}

}  // namespace vp::detail
