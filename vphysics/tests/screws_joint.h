// A user-defined joint whose motion subspace changes in the link frame, for tests that need its
// derivatives, and random trees with it.
#pragma once

#include <array>

#include "trees.h"
#include "vphysics/lie/dual.h"

namespace vp::test {

template <class T>
se3T<T> as(const se3& V) {
  return {{T(V.w.x), T(V.w.y), T(V.w.z)}, {T(V.v.x), T(V.v.y), T(V.v.z)}};
}

template <class T>
InertiaT<T> as(const Inertia& J) {
  const Vec3& h = J.first_moment();
  const Sym3& I = J.rotational();
  return {T(J.mass()),
          {T(h.x), T(h.y), T(h.z)},
          {T(I.xx), T(I.yy), T(I.zz), T(I.xy), T(I.yz), T(I.zx)}};
}
template <class T>
SE3T<T> as(const SE3& A) {
  const auto each = [](const Vec3& a) { return Vec3T<T>{T(a.x), T(a.y), T(a.z)}; };
  const Mat3& R = A.rotation();
  return {Mat3T<T>{each(R.cx), each(R.cy), each(R.cz)}, each(A.position())};
}

// T(q) = product over k of Exp(q_k s_k + q_k^2 t_k / 2), N degrees of freedom. Dual numbers give
// everything but T: S from the derivative of T, the rate from the derivative of S along v, and so
// on.
template <int N>
class ScrewsJoint final : public UserJoint {
 public:
  ScrewsJoint(Random& random, bool says_slopes = true) : says_slopes_(says_slopes) {
    for (int k = 0; k < N; ++k) {
      s_.push_back({random.direction(), random.in_cube(1)});
      t_.push_back({random.in_cube(0.5), random.in_cube(0.5)});
    }
  }

  template <class T>
  SE3T<T> pose(const std::array<T, N>& q) const {
    SE3T<T> X;
    for (std::size_t k = 0; k < N; ++k) {
      X = X * Exp(q[k] * (as<T>(s_[k]) + (T(0.5) * q[k]) * as<T>(t_[k])));
    }
    return X;
  }
  // X^-1 dX/dq_k
  template <class T>
  std::array<se3T<T>, N> subspace(const std::array<T, N>& q) const {
    std::array<se3T<T>, N> S;
    for (std::size_t k = 0; k < N; ++k) {
      const SE3T<DualT<T>> X = pose(moved(q, k, T(1)));
      const auto slope = [](const Vec3T<DualT<T>>& a) {
        return Vec3T<T>{a.x.derivative[0], a.y.derivative[0], a.z.derivative[0]};
      };
      const auto value = [](const Vec3T<DualT<T>>& a) {
        return Vec3T<T>{a.x.value, a.y.value, a.z.value};
      };
      const auto& R = X.rotation();
      const Mat3T<T> at = {value(R.cx), value(R.cy), value(R.cz)};
      const Mat3T<T> W = transposed_times(at, Mat3T<T>{slope(R.cx), slope(R.cy), slope(R.cz)});
      S[k] = {{W.cy.z, W.cz.x, W.cx.y}, transposed_times(at, slope(X.position()))};
    }
    return S;
  }
  // (dS/dt) v
  template <class T>
  se3T<T> rate(const std::array<T, N>& q, const std::array<T, N>& v) const {
    std::array<DualT<T>, N> along;
    for (std::size_t k = 0; k < N; ++k) {
      along[k] = DualT<T>(q[k]);
      along[k].derivative[0] = v[k];
    }
    const auto S = subspace(along);
    se3T<T> sum;
    for (std::size_t k = 0; k < N; ++k) sum = sum + v[k] * slope_of(S[k]);
    return sum;
  }

  int degrees_of_freedom() const override { return N; }
  void evaluate(std::span<const double> q, std::span<const double> v, SE3& T_joint_link,
                std::span<se3> S, se3& rate_of_S) const override {
    const std::array<double, N> at = array(q);
    T_joint_link = pose(at);
    const auto columns = subspace(at);
    std::copy(columns.begin(), columns.end(), S.begin());
    rate_of_S = rate(at, array(v));
  }
  bool subspace_derivatives(std::span<const double> q, std::span<const double> v,
                            std::span<se3> dS_dq, std::span<se3> drate_dq) const override {
    if (!says_slopes_) return false;
    std::array<DualT<double>, N> constant;
    for (std::size_t k = 0; k < N; ++k) constant[k] = v[k];
    for (std::size_t l = 0; l < N; ++l) {
      const auto at = moved(array(q), l, 1.0);
      const auto S = subspace(at);
      for (std::size_t k = 0; k < N; ++k) dS_dq[N * k + l] = slope_of(S[k]);
      drate_dq[l] = slope_of(rate(at, constant));
    }
    return true;
  }

 private:
  static std::array<double, N> array(std::span<const double> x) {
    std::array<double, N> out;
    std::copy(x.begin(), x.end(), out.begin());
    return out;
  }
  template <class T>
  static std::array<DualT<T>, N> moved(const std::array<T, N>& q, std::size_t k, const T& slope) {
    std::array<DualT<T>, N> out;
    for (std::size_t i = 0; i < N; ++i) out[i] = DualT<T>(q[i]);
    out[k].derivative[0] = slope;
    return out;
  }
  template <class T>
  static se3T<T> slope_of(const se3T<DualT<T>>& V) {
    return {{V.w.x.derivative[0], V.w.y.derivative[0], V.w.z.derivative[0]},
            {V.v.x.derivative[0], V.v.y.derivative[0], V.v.z.derivative[0]}};
  }

  bool says_slopes_;
  std::vector<se3> s_, t_;
};

// As random_tree, with user-defined joints of one and of two degrees of freedom among the others.
inline Model tree_with_screws(Random& random, int links) {
  ModelBuilder builder;
  for (int i = 0; i < links; ++i) {
    LinkSpec link;
    link.name = "link " + std::to_string(i);
    link.parent = static_cast<int>(random.word() % static_cast<unsigned>(i + 1)) - 1;
    const int kind = static_cast<int>(random.word() % 12);
    if (kind < 10) link.joint = random_joint(random, kind);
    if (kind == 10) link.joint = std::make_shared<ScrewsJoint<1>>(random);
    if (kind == 11) link.joint = std::make_shared<ScrewsJoint<2>>(random);
    link.T_parent_joint = random.pose(0.5);
    link.inertia = random_body(random);
    link.armature = 0.05;
    link.damping = random.uniform(0.0, 0.2);
    must_build(builder.add(link));
  }
  return must_build(builder.build());
}

}  // namespace vp::test
