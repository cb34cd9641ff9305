// The group SE(3), its algebra se(3) and the dual dse(3): paper, sections 4.1 to 4.3, appendix B.
//
// Ad_T V    = (R w, R v + p x R w)            velocity of frame b, T = T_a_b, seen from frame a
// dAd_T F   = (R^T (m - p x f), R^T f)        the transpose of Ad_T: <Ad_T V, F> = <V, dAd_T F>
// ad_V1 V2  = (w1 x w2, w1 x v2 + v1 x w2)
// dad_V F   = (m x w + f x v, f x w)          eq. (4); <ad_V X, F> = <X, dad_V F>
// Newton's law reads F = J V' - dad_V (J V) with these (appendix A; eq. (3) has the other sign).
//
// SE3 is a group: there is multiplication and substitution, no addition (section 4.3).
#pragma once

#include "vphysics/lie/scalar.h"
#include "vphysics/lie/vec3.h"

namespace vp {

template <class T>
struct se3T {
  Vec3T<T> w, v;
  constexpr bool operator==(const se3T&) const = default;
};

template <class T>
struct dse3T {
  Vec3T<T> m, f;
  constexpr bool operator==(const dse3T&) const = default;
};

template <class T>
class SE3T {
 public:
  constexpr SE3T() : R_(Mat3T<T>::identity()) {}
  // Precondition: R is a rotation.
  constexpr SE3T(const Mat3T<T>& R, const Vec3T<T>& p) : R_(R), p_(p) {}
  constexpr explicit SE3T(const Vec3T<T>& p) : R_(Mat3T<T>::identity()), p_(p) {}

  constexpr const Mat3T<T>& rotation() const { return R_; }
  constexpr const Vec3T<T>& position() const { return p_; }
  constexpr Vec3T<T> rotate(const Vec3T<T>& v) const { return R_ * v; }
  constexpr Vec3T<T> unrotate(const Vec3T<T>& v) const { return transposed_times(R_, v); }
  constexpr bool operator==(const SE3T&) const = default;

 private:
  Mat3T<T> R_;
  Vec3T<T> p_;
};

template <class T>
constexpr SE3T<T> operator*(const SE3T<T>& A, const SE3T<T>& B) {
  return {A.rotation() * B.rotation(), A.position() + A.rotate(B.position())};
}
// A point, from frame b to frame a with T_a_b.
template <class T>
constexpr Vec3T<T> operator*(const SE3T<T>& A, const Vec3T<T>& point) {
  return A.position() + A.rotate(point);
}
template <class T>
constexpr SE3T<T> Inv(const SE3T<T>& A) {
  return {transpose(A.rotation()), -A.unrotate(A.position())};
}
// Inv(A) * point, without building the inverse.
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
// Reciprocal product: power of a force on a velocity.
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

namespace detail {

// Squared angles [rad^2] below which (theta - sin theta) / theta^3 and the coefficient of Log come
// from their series. There the seven (six) terms leave out less than 2^-53 of the value, and above
// the closed form loses at most 4 bits of a coefficient that is multiplied by theta^2: the result
// is within some 1e-16 on either side.
inline constexpr double kExpSeriesBelow = 0.45;
inline constexpr double kLogSeriesBelow = 0.1;

// C = (theta - sin theta) / theta^3 from theta^2 and A = sin theta / theta.
template <class T>
T exp_c(T t2, T A) {
  if (t2 >= T(kExpSeriesBelow)) return (T(1) - A) / t2;
  T c = T(1.0 / 1307674368000.0);
  c = T(1.0 / 6227020800.0) - t2 * c;
  c = T(1.0 / 39916800.0) - t2 * c;
  c = T(1.0 / 362880.0) - t2 * c;
  c = T(1.0 / 5040.0) - t2 * c;
  c = T(1.0 / 120.0) - t2 * c;
  return T(1.0 / 6.0) - t2 * c;
}

// D = (1 - (theta/2) cot(theta/2)) / theta^2, c = (theta/2) cot(theta/2).
template <class T>
T log_d(T t2, T c) {
  if (t2 >= T(kLogSeriesBelow)) return (T(1) - c) / t2;
  T d = T(691.0 / 1307674368000.0);
  d = T(1.0 / 47900160.0) + t2 * d;
  d = T(1.0 / 1209600.0) + t2 * d;
  d = T(1.0 / 30240.0) + t2 * d;
  d = T(1.0 / 720.0) + t2 * d;
  return T(1.0 / 12.0) + t2 * d;
}

template <class T>
Mat3T<T> rotation_of(const Vec3T<T>& w, T A, T B) {
  const T xy = B * w.x * w.y, yz = B * w.y * w.z, zx = B * w.z * w.x;
  const T xx = B * w.x * w.x, yy = B * w.y * w.y, zz = B * w.z * w.z;
  return {{T(1) - yy - zz, xy + A * w.z, zx - A * w.y},
          {xy - A * w.z, T(1) - zz - xx, yz + A * w.x},
          {zx + A * w.y, yz - A * w.x, T(1) - xx - yy}};
}

// A = sin(theta)/theta and B = (1 - cos(theta))/theta^2 without cancellation at any angle: with
// s = sin(theta/2)/(theta/2), B = s^2/2 and A = s cos(theta/2).
template <class T>
struct ExpCoefficients {
  T t2, A, B;
};
template <class T>
ExpCoefficients<T> exp_coefficients(const Vec3T<T>& w) {
  const T t2 = dot(w, w);
  const T half = T(0.5) * std::sqrt(t2);
  const auto [s, c] = sin_cos(half);
  const T sinc = half > T(0) ? s / half : T(1);
  return {t2, sinc * c, T(0.5) * sinc * sinc};
}

}  // namespace detail

// Rotation about w by |w| radians.
template <class T>
Mat3T<T> Exp(const Vec3T<T>& w) {
  const auto k = detail::exp_coefficients(w);
  return detail::rotation_of(w, k.A, k.B);
}

// p = v + B w x v + C w x (w x v)
template <class T>
SE3T<T> Exp(const se3T<T>& V) {
  const auto k = detail::exp_coefficients(V.w);
  const Vec3T<T> wv = cross(V.w, V.v);
  const T C = detail::exp_c(k.t2, k.A);
  return {detail::rotation_of(V.w, k.A, k.B), V.v + k.B * wv + C * cross(V.w, wv)};
}

// The inverse of Exp with |w| <= pi. The angle is taken from the quaternion, which is well
// conditioned near 0 and near pi alike; at a half turn exactly, either axis may be returned.
template <class T>
se3T<T> Log(const SE3T<T>& A) {
  const QuaternionT<T> q = to_quaternion(A.rotation());
  const Vec3T<T> u{q.x, q.y, q.z};
  const T n = norm(u);  // sin(theta/2)
  const T half = arc_tangent(n, q.w);
  // Below n = 2^-500 squares underflow; half/n is then 1 to the last bit, as it is for n < 1e-8.
  const Vec3T<T> w = (n > T(0) ? T(2) * half / n : T(2)) * u;
  const T t2 = T(4) * half * half;
  const T D = detail::log_d(t2, n > T(0) ? half * q.w / n : T(1));
  const Vec3T<T> wp = cross(w, A.position());
  return {w, A.position() - T(0.5) * wp + D * cross(w, wp)};
}

// The rotation nearest to R, for an R that rounding has moved a little from SO(3): one Newton step
// of the polar decomposition, R (3 - R^T R) / 2; the error is squared.
template <class T>
Mat3T<T> orthonormalized(const Mat3T<T>& R) {
  const T xx = dot(R.cx, R.cx), yy = dot(R.cy, R.cy), zz = dot(R.cz, R.cz);
  const T xy = T(0.5) * dot(R.cx, R.cy), yz = T(0.5) * dot(R.cy, R.cz),
          zx = T(0.5) * dot(R.cz, R.cx);
  const T half = T(0.5), k = T(1.5);
  return {(k - half * xx) * R.cx - xy * R.cy - zx * R.cz,
          (k - half * yy) * R.cy - yz * R.cz - xy * R.cx,
          (k - half * zz) * R.cz - zx * R.cx - yz * R.cy};
}

using SE3 = SE3T<double>;
using se3 = se3T<double>;
using dse3 = dse3T<double>;

static_assert(sizeof(SE3) == 12 * sizeof(double));
static_assert(sizeof(se3) == 6 * sizeof(double));

}  // namespace vp
