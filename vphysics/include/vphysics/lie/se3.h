// The group SE(3), its algebra se(3) and the dual dse(3): paper, sections 4.1 to 4.3, appendix B.
//
// Ad_T V    = (R w, R v + p x R w)            velocity of frame b, T = T_a_b, in frame a
// dAd_T F   = (R^T (m - p x f), R^T f)        the transpose of Ad_T: <Ad_T V, F> = <V, dAd_T F>
// ad_V1 V2  = (w1 x w2, w1 x v2 + v1 x w2)
// dad_V F   = (m x w + f x v, f x w)          eq. (4); <ad_V X, F> = <X, dad_V F>
// With these, Newton's law reads F = J V' - dad_V (J V) (appendix A; eq. (3) has the other sign).
//
// SE3 is a group: it has multiplication and assignment, but no addition (section 4.3).
#pragma once

#include "vphysics/lie/so3.h"

namespace vp {

template <class T>
struct se3T {
  Vec3T<T> w, v;
  bool operator==(const se3T&) const = default;
};

template <class T>
struct dse3T {
  Vec3T<T> m, f;
  bool operator==(const dse3T&) const = default;
};

template <class T>
class SE3T {
 public:
  constexpr SE3T() : R_(Mat3T<T>::identity()) {}
  // Precondition: R is a rotation.
  constexpr SE3T(const Mat3T<T>& R, const Vec3T<T>& p) : R_(R), p_(p) {}
  constexpr SE3T(const SO3T<T>& R, const Vec3T<T>& p) : R_(R.matrix()), p_(p) {}
  constexpr explicit SE3T(const Vec3T<T>& p) : R_(Mat3T<T>::identity()), p_(p) {}

  constexpr const Mat3T<T>& rotation() const { return R_; }
  constexpr const Vec3T<T>& position() const { return p_; }
  constexpr Vec3T<T> rotate(const Vec3T<T>& v) const { return R_ * v; }
  constexpr Vec3T<T> unrotate(const Vec3T<T>& v) const { return transposed_times(R_, v); }
  bool operator==(const SE3T&) const = default;

 private:
  Mat3T<T> R_;
  Vec3T<T> p_;
};

template <class T>
constexpr SE3T<T> operator*(const SE3T<T>& A, const SE3T<T>& B) {
  return {A.rotation() * B.rotation(), A.position() + A.rotate(B.position())};
}
// Transforms a point from frame b to frame a, with T_a_b.
template <class T>
constexpr Vec3T<T> operator*(const SE3T<T>& A, const Vec3T<T>& point) {
  return A.position() + A.rotate(point);
}
template <class T>
constexpr SE3T<T> Inv(const SE3T<T>& A) {
  return {transpose(A.rotation()), -A.unrotate(A.position())};
}
// Inv(A) * point, without computing the inverse.
template <class T>
constexpr Vec3T<T> inverse_times(const SE3T<T>& A, const Vec3T<T>& point) {
  return A.unrotate(point - A.position());
}

template <class T>
constexpr se3T<T> operator+(const se3T<T>& a, const se3T<T>& b) {
  return {a.w + b.w, a.v + b.v};
}
template <class T>
constexpr se3T<T> operator-(const se3T<T>& a, const se3T<T>& b) {
  return {a.w - b.w, a.v - b.v};
}
template <class T>
constexpr se3T<T> operator*(T s, const se3T<T>& a) {
  return {s * a.w, s * a.v};
}
template <class T>
constexpr dse3T<T> operator+(const dse3T<T>& a, const dse3T<T>& b) {
  return {a.m + b.m, a.f + b.f};
}
template <class T>
constexpr dse3T<T> operator-(const dse3T<T>& a, const dse3T<T>& b) {
  return {a.m - b.m, a.f - b.f};
}
template <class T>
constexpr dse3T<T> operator*(T s, const dse3T<T>& a) {
  return {s * a.m, s * a.f};
}
// Reciprocal product: the power of a wrench on a twist.
template <class T>
constexpr T operator*(const se3T<T>& V, const dse3T<T>& F) {
  return dot(V.w, F.m) + dot(V.v, F.f);
}
template <class T>
constexpr T operator*(const dse3T<T>& F, const se3T<T>& V) {
  return V * F;
}

template <class T>
constexpr se3T<T> Ad(const SE3T<T>& A, const se3T<T>& V) {
  const Vec3T<T> w = A.rotate(V.w);
  return {w, A.rotate(V.v) + cross(A.position(), w)};
}
template <class T>
constexpr dse3T<T> dAd(const SE3T<T>& A, const dse3T<T>& F) {
  return {A.unrotate(F.m - cross(A.position(), F.f)), A.unrotate(F.f)};
}
template <class T>
constexpr se3T<T> ad(const se3T<T>& V1, const se3T<T>& V2) {
  return {cross(V1.w, V2.w), cross(V1.w, V2.v) + cross(V1.v, V2.w)};
}
template <class T>
constexpr dse3T<T> dad(const se3T<T>& V, const dse3T<T>& F) {
  return {cross(F.m, V.w) + cross(F.f, V.v), cross(F.f, V.w)};
}

// Ad and dAd of the inverse, without computing it.
template <class T>
constexpr se3T<T> InvAd(const SE3T<T>& A, const se3T<T>& V) {
  return {A.unrotate(V.w), A.unrotate(V.v - cross(A.position(), V.w))};
}
template <class T>
constexpr dse3T<T> InvdAd(const SE3T<T>& A, const dse3T<T>& F) {
  const Vec3T<T> f = A.rotate(F.f);
  return {A.rotate(F.m) + cross(A.position(), f), f};
}

// --- Exp, Log and the Jacobians

// p = v + B w x v + C w x (w x v)
template <class T>
SE3T<T> Exp(const se3T<T>& V) {
  const auto k = detail::exp_coefficients(V.w);
  const Vec3T<T> wv = cross(V.w, V.v);
  const T C = detail::coefficient_C(k);
  return {detail::quadratic(V.w, k.A, k.B), V.v + k.B * wv + C * cross(V.w, wv)};
}

// The inverse of Exp with |w| <= pi: v = J_l^-1(w) p.
template <class T>
se3T<T> Log(const SE3T<T>& A) {
  const Vec3T<T> w = Log(SO3T<T>(A.rotation()));
  const T D = detail::coefficient_D(detail::exp_coefficients(w));
  const Vec3T<T> wp = cross(w, A.position());
  return {w, A.position() - T(0.5) * wp + D * cross(w, wp)};
}

// A Jacobian of Exp on SE(3), 6x6 of the form [J 0; Q J]: maps a change of V to a twist.
template <class T>
struct SE3JacobianT {
  Mat3T<T> J, Q;

  constexpr se3T<T> operator*(const se3T<T>& V) const { return {J * V.w, Q * V.w + J * V.v}; }
  // The transpose maps a wrench to the force along the coordinates.
  constexpr dse3T<T> transposed_times(const dse3T<T>& F) const {
    return {vp::transposed_times(J, F.m) + vp::transposed_times(Q, F.f),
            vp::transposed_times(J, F.f)};
  }
};

namespace detail {

// The derivative along v, at w, of 1 + a [w] + b [w]^2; a1 and b1 are the derivatives of a and b
// with respect to t = |w|^2.
template <class T>
Mat3T<T> quadratic_derivative(const Vec3T<T>& w, const Vec3T<T>& v, const T& a, const T& a1,
                              const T& b, const T& b1) {
  const T wv = dot(w, v), t1 = T(2) * wv, t = dot(w, w);
  const T k1 = t1 * a1, k2 = t1 * b1;
  const Vec3T<T> c = k1 * w + a * v;  // of a [w]
  const Vec3T<T> d = k2 * w + b * v;  // of b w w^T: d w^T + b w v^T
  const T s = k2 * t + b * t1;        // of b t
  const Vec3T<T> e = b * w;
  const auto column = [&](const T& wi, const T& vi) { return wi * d + vi * e; };
  Mat3T<T> out = skew(c) + Mat3T<T>{column(w.x, v.x), column(w.y, v.y), column(w.z, v.z)};
  out.cx.x -= s;
  out.cy.y -= s;
  out.cz.z -= s;
  return out;
}

// dB/dt = (A - 2 B) / (2 t), dC/dt = (B - 3 C) / (2 t), and dD/dt; their series for small t. Above
// the switching point they lose up to 5 bits, but are multiplied by theta^2 or more.
inline constexpr double kDerivativeB[] = {
    -1.0 / 24,        2.0 / 720,           -3.0 / 40320,           4.0 / 3628800,
    -5.0 / 479001600, 6.0 / 87178291200.0, -7.0 / 20922789888000.0};
inline constexpr double kDerivativeC[] = {-1.0 / 120,
                                          2.0 / 5040,
                                          -3.0 / 362880,
                                          4.0 / 39916800,
                                          -5.0 / 6227020800.0,
                                          6.0 / 1307674368000.0,
                                          -7.0 / 355687428096000.0};
inline constexpr double kDerivativeD[] = {1.0 / 720,
                                          2.0 / 30240,
                                          3.0 / 1209600,
                                          4.0 / 47900160,
                                          5 * 691.0 / 1307674368000.0,
                                          6.0 / 74724249600.0,
                                          7 * 3617.0 / 10670622842880000.0};
template <class T>
T derivative_B(const ExpCoefficients<T>& k) {
  return choose(
      k.t < T(kExpSeriesBelow), [&] { return polynomial(k.t, kDerivativeB); },
      [&] { return (k.A - T(2) * k.B) / (T(2) * k.t); });
}
template <class T>
T derivative_C(const ExpCoefficients<T>& k, const T& C) {
  return choose(
      k.t < T(kExpSeriesBelow), [&] { return polynomial(k.t, kDerivativeC); },
      [&] { return (k.B - T(3) * C) / (T(2) * k.t); });
}
// From D = (1 - A / (2 B)) / t with dA/dt = (C - B) / 2.
template <class T>
T derivative_D(const ExpCoefficients<T>& k, const T& D) {
  return choose(
      k.t < T(kLogSeriesBelow), [&] { return polynomial(k.t, kDerivativeD); },
      [&] {
        const T A1 = T(0.5) * (coefficient_C(k) - k.B), B1 = derivative_B(k);
        return -(T(0.5) * (A1 - k.A * B1 / k.B) / k.B + D) / k.t;
      });
}

}  // namespace detail

// Exp(V + d) = Exp(J d) Exp(V) to first order. se(3) is so(3) over the dual numbers w + e v, so Q
// is the derivative of J_l along v.
template <class T>
SE3JacobianT<T> left_jacobian(const se3T<T>& V) {
  const auto k = detail::exp_coefficients(V.w);
  const T C = detail::coefficient_C(k);
  return {detail::quadratic(V.w, k.B, C),
          detail::quadratic_derivative(V.w, V.v, k.B, detail::derivative_B(k), C,
                                       detail::derivative_C(k, C))};
}
// Exp(V + d) = Exp(V) Exp(J d)
template <class T>
SE3JacobianT<T> right_jacobian(const se3T<T>& V) {
  return left_jacobian(T(-1) * V);
}
// Precondition: |w| < 2 pi.
template <class T>
SE3JacobianT<T> left_jacobian_inverse(const se3T<T>& V) {
  const auto k = detail::exp_coefficients(V.w);
  const T D = detail::coefficient_D(k);
  return {detail::quadratic(V.w, T(-0.5), D),
          detail::quadratic_derivative(V.w, V.v, T(-0.5), T(0), D, detail::derivative_D(k, D))};
}
template <class T>
SE3JacobianT<T> right_jacobian_inverse(const se3T<T>& V) {
  return left_jacobian_inverse(T(-1) * V);
}

// The pose at fraction s from A to B, along the screw between them.
template <class T>
SE3T<T> interpolate(const SE3T<T>& A, const SE3T<T>& B, const std::type_identity_t<T>& s) {
  return A * Exp(s * Log(Inv(A) * B));
}

using SE3 = SE3T<double>;
using se3 = se3T<double>;
using SE3Jacobian = SE3JacobianT<double>;
using dse3 = dse3T<double>;

static_assert(sizeof(SE3) == 12 * sizeof(double));
static_assert(sizeof(se3) == 6 * sizeof(double));

}  // namespace vp
