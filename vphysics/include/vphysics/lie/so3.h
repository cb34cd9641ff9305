// The group SO(3) of rotations; its algebra so(3) is represented by the vectors w of R^3.
//
//   Exp w  = 1 + A [w] + B [w]^2          rotation about w by theta = |w|
//   J_l(w) = 1 + B [w] + C [w]^2          left Jacobian:  Exp(w + d) = Exp(J_l d) Exp(w)
//   J_r(w) = J_l(-w)                      right Jacobian: Exp(w + d) = Exp(w) Exp(J_r d)
//   J_l^-1 = 1 - [w] / 2 + D [w]^2
//
//   A = sin(theta) / theta           B = (1 - cos(theta)) / theta^2
//   C = (1 - A) / theta^2            D = (1 - A / (2 B)) / theta^2
//
// A to D are analytic functions of t = theta^2. Below a switching point their series are summed:
// this avoids division by a small angle, and dual numbers get the derivatives at 0 too. Source:
// Murray, Li, Sastry, A Mathematical Introduction to Robotic Manipulation, 1994, chapter 2; paper,
// appendix B.
#pragma once

#include "vphysics/lie/scalar.h"
#include "vphysics/lie/vec3.h"

namespace vp {

// A rotation. R_a_b maps the coordinates of a vector in frame b to those in frame a. A group: it
// has multiplication and assignment, but no addition.
template <class T>
class SO3T {
 public:
  constexpr SO3T() : R_(Mat3T<T>::identity()) {}
  // Precondition: R is a rotation.
  constexpr explicit SO3T(const Mat3T<T>& R) : R_(R) {}
  constexpr const Mat3T<T>& matrix() const { return R_; }
  bool operator==(const SO3T&) const = default;

 private:
  Mat3T<T> R_;
};

template <class T>
constexpr SO3T<T> operator*(const SO3T<T>& A, const SO3T<T>& B) {
  return SO3T<T>(A.matrix() * B.matrix());
}
template <class T>
constexpr Vec3T<T> operator*(const SO3T<T>& A, const Vec3T<T>& v) {
  return A.matrix() * v;
}
template <class T>
constexpr SO3T<T> Inv(const SO3T<T>& A) {
  return SO3T<T>(transpose(A.matrix()));
}
// Ad_R w = R w, the angular velocity w in the other frame.
template <class T>
constexpr Vec3T<T> Ad(const SO3T<T>& A, const Vec3T<T>& w) {
  return A.matrix() * w;
}

// --- quaternions

// Unit quaternion (x, y, z, w) of a rotation; w >= 0.
template <class T>
struct QuaternionT {
  T x{}, y{}, z{}, w{1};
};

// Shepperd's method: it selects the largest of the four components first. This avoids division by a
// small number, and the result is accurate at rotations near pi.
template <class T>
QuaternionT<T> to_quaternion(const Mat3T<T>& R) {
  using std::sqrt;
  const T xx = R.cx.x, yy = R.cy.y, zz = R.cz.z;
  const T trace = xx + yy + zz, one = T(1);
  const T x = R.cy.z - R.cz.y, y = R.cz.x - R.cx.z, z = R.cx.y - R.cy.x;
  const T xy = R.cx.y + R.cy.x, yz = R.cy.z + R.cz.y, zx = R.cz.x + R.cx.z;
  const auto by_w = both(trace >= xx, both(trace >= yy, trace >= zz));
  const auto by_x = both(xx >= yy, xx >= zz), by_y = yy >= zz;
  const auto pick = [&](const T& w_first, const T& x_first, const T& y_first, const T& z_first) {
    return select(by_w, w_first, select(by_x, x_first, select(by_y, y_first, z_first)));
  };
  const QuaternionT<T> q = {pick(x, one + xx - yy - zz, xy, zx),
                            pick(y, xy, one + yy - zz - xx, yz),
                            pick(z, zx, yz, one + zz - xx - yy), pick(one + trace, x, y, z)};
  const T n = sqrt(q.x * q.x + q.y * q.y + q.z * q.z + q.w * q.w);
  const T s = select(q.w < T(0), T(-1), T(1)) / n;
  return {q.x * s, q.y * s, q.z * s, q.w * s};
}
template <class T>
QuaternionT<T> to_quaternion(const SO3T<T>& R) {
  return to_quaternion(R.matrix());
}

// Accepts any quaternion except zero; normalises it.
template <class T>
Mat3T<T> from_quaternion(const QuaternionT<T>& q) {
  const T s = T(2) / (q.x * q.x + q.y * q.y + q.z * q.z + q.w * q.w);
  const T xx = s * q.x * q.x, yy = s * q.y * q.y, zz = s * q.z * q.z;
  const T xy = s * q.x * q.y, yz = s * q.y * q.z, zx = s * q.z * q.x;
  const T wx = s * q.w * q.x, wy = s * q.w * q.y, wz = s * q.w * q.z;
  return {{T(1) - yy - zz, xy + wz, zx - wy},
          {xy - wz, T(1) - zz - xx, yz + wx},
          {zx + wy, yz - wx, T(1) - xx - yy}};
}

// The group of unit quaternions: R(p q) = R(p) R(q), R(conjugate(q)) = R(q)^T.
template <class T>
constexpr QuaternionT<T> operator*(const QuaternionT<T>& p, const QuaternionT<T>& q) {
  return {
      p.w * q.x + p.x * q.w + p.y * q.z - p.z * q.y, p.w * q.y + p.y * q.w + p.z * q.x - p.x * q.z,
      p.w * q.z + p.z * q.w + p.x * q.y - p.y * q.x, p.w * q.w - p.x * q.x - p.y * q.y - p.z * q.z};
}
template <class T>
constexpr QuaternionT<T> conjugate(const QuaternionT<T>& q) {
  return {-q.x, -q.y, -q.z, q.w};
}
// Precondition: not zero.
template <class T>
QuaternionT<T> normalized(const QuaternionT<T>& q) {
  using std::sqrt;
  const T s = T(1) / sqrt(q.x * q.x + q.y * q.y + q.z * q.z + q.w * q.w);
  return {s * q.x, s * q.y, s * q.z, s * q.w};
}

// --- the coefficients A to D

namespace detail {

// The series is summed below these values of t = theta^2. Its omitted terms are less than 2^-54 of
// the sum there. Above, C and D lose at most 5 bits to cancellation, but they are always multiplied
// by theta^2 = t, so that the error of a result is below 2^-53 on both sides.
inline constexpr double kExpSeriesBelow = 0.25;
inline constexpr double kLogSeriesBelow = 0.1;

// sum over k of c[k] t^k
template <class T, std::size_t N>
constexpr T polynomial(const T& t, const double (&c)[N]) {
  T sum = T(c[N - 1]);
  for (std::size_t k = N - 1; k-- > 0;) sum = sum * t + T(c[k]);
  return sum;
}

// A: (-1)^k / (2k+1)!, B: (-1)^k / (2k+2)!, C: (-1)^k / (2k+3)!
inline constexpr double kSeriesA[] = {1.0,          -1.0 / 6,        1.0 / 120,         -1.0 / 5040,
                                      1.0 / 362880, -1.0 / 39916800, 1.0 / 6227020800.0};
inline constexpr double kSeriesB[] = {
    1.0 / 2,       -1.0 / 24,        1.0 / 720,          -1.0 / 40320,
    1.0 / 3628800, -1.0 / 479001600, 1.0 / 87178291200.0};
inline constexpr double kSeriesC[] = {
    1.0 / 6,        -1.0 / 120,          1.0 / 5040,           -1.0 / 362880,
    1.0 / 39916800, -1.0 / 6227020800.0, 1.0 / 1307674368000.0};
// D: |B_2k| / (2k)! is the coefficient of t^(k-1), B_2k the Bernoulli numbers
inline constexpr double kSeriesD[] = {1.0 / 12,           1.0 / 720,      1.0 / 30240,
                                      1.0 / 1209600,      1.0 / 47900160, 691.0 / 1307674368000.0,
                                      1.0 / 74724249600.0};

template <class T>
struct ExpCoefficients {
  T t, A, B;
};

// Above the switching point, by the half angle: s = sin(theta/2) / (theta/2), A = s cos(theta/2), B
// = s^2 / 2. This avoids the cancellation of 1 - cos.
template <class T>
ExpCoefficients<T> exp_coefficients(const Vec3T<T>& w) {
  using std::sqrt;
  const T t = dot(w, w);
  const auto small = t < T(kExpSeriesBelow);
  SinCosT<T> half{};
  if (!all(small)) {
    const T h = T(0.5) * sqrt(t);
    half = sin_cos(h);
    half.sin = half.sin / h;
  }
  return {t,
          choose(
              small, [&] { return polynomial(t, kSeriesA); }, [&] { return half.sin * half.cos; }),
          choose(
              small, [&] { return polynomial(t, kSeriesB); },
              [&] { return T(0.5) * half.sin * half.sin; })};
}
template <class T>
T coefficient_C(const ExpCoefficients<T>& k) {
  return choose(
      k.t < T(kExpSeriesBelow), [&] { return polynomial(k.t, kSeriesC); },
      [&] { return (T(1) - k.A) / k.t; });
}
template <class T>
T coefficient_D(const ExpCoefficients<T>& k) {
  return choose(
      k.t < T(kLogSeriesBelow), [&] { return polynomial(k.t, kSeriesD); },
      [&] { return (T(1) - T(0.5) * k.A / k.B) / k.t; });
}

// 1 + a [w] + b [w]^2, with [w]^2 = w w^T - t 1
template <class T>
constexpr Mat3T<T> quadratic(const Vec3T<T>& w, const T& a, const T& b) {
  const T xy = b * w.x * w.y, yz = b * w.y * w.z, zx = b * w.z * w.x;
  const T xx = b * w.x * w.x, yy = b * w.y * w.y, zz = b * w.z * w.z;
  return {{T(1) - yy - zz, xy + a * w.z, zx - a * w.y},
          {xy - a * w.z, T(1) - zz - xx, yz + a * w.x},
          {zx + a * w.y, yz - a * w.x, T(1) - xx - yy}};
}

}  // namespace detail

// --- Exp, Log and the Jacobians

template <class T>
SO3T<T> Exp(const Vec3T<T>& w) {
  const auto k = detail::exp_coefficients(w);
  return SO3T<T>(detail::quadratic(w, k.A, k.B));
}
// The quaternion of Exp(w): (sin(theta/2) w / theta, cos(theta/2)). It is continuous in w, so its
// real part may be negative.
template <class T>
QuaternionT<T> exp_quaternion(const Vec3T<T>& w) {
  using std::sqrt;
  const T u = T(0.25) * dot(w, w);
  const auto small = u < T(detail::kExpSeriesBelow);
  SinCosT<T> half{};
  if (!all(small)) {
    const T h = sqrt(u);
    half = sin_cos(h);
    half.sin = half.sin / h;
  }
  const T s = choose(
      small, [&] { return detail::polynomial(u, detail::kSeriesA); }, [&] { return half.sin; });
  const T c = choose(
      small, [&] { return T(1) - u * detail::polynomial(u, detail::kSeriesB); },
      [&] { return half.cos; });
  const T k = T(0.5) * s;
  return {k * w.x, k * w.y, k * w.z, c};
}
// The inverse of Exp with |w| <= pi. The angle is computed from the quaternion, which is well
// conditioned near 0 and near pi. At exactly pi, either axis may be returned.
template <class T>
Vec3T<T> Log(const SO3T<T>& R);

template <class T>
Mat3T<T> left_jacobian(const Vec3T<T>& w) {
  const auto k = detail::exp_coefficients(w);
  return detail::quadratic(w, k.B, detail::coefficient_C(k));
}
template <class T>
Mat3T<T> right_jacobian(const Vec3T<T>& w) {
  return left_jacobian(-w);
}
// Precondition: |w| < 2 pi.
template <class T>
Mat3T<T> left_jacobian_inverse(const Vec3T<T>& w) {
  return detail::quadratic(w, T(-0.5), detail::coefficient_D(detail::exp_coefficients(w)));
}
template <class T>
Mat3T<T> right_jacobian_inverse(const Vec3T<T>& w) {
  return left_jacobian_inverse(-w);
}

// Log of a unit quaternion of either sign.
template <class T>
Vec3T<T> Log(const QuaternionT<T>& q) {
  using std::sqrt;
  const T sign = select(q.w < T(0), T(-1), T(1));
  const Vec3T<T> u{sign * q.x, sign * q.y, sign * q.z};
  const T n2 = dot(u, u);  // sin^2(theta/2)
  // theta / sin(theta/2) = 2 asin(n) / n
  static constexpr double kSeries[] = {2.0,        1.0 / 3,     3.0 / 20,     5.0 / 56,
                                       35.0 / 576, 63.0 / 1408, 231.0 / 6656, 143.0 / 5120};
  const T scale = choose(
      n2 < T(0.01), [&] { return detail::polynomial(n2, kSeries); },
      [&] {
        const T n = sqrt(n2);
        return T(2) * arc_tangent(n, sign * q.w) / n;
      });
  return scale * u;
}
template <class T>
Vec3T<T> Log(const SO3T<T>& R) {
  return Log(to_quaternion(R.matrix()));
}

// The nearest rotation to R, for an R close to SO(3) within rounding: one Newton step of the polar
// decomposition, R (3 - R^T R) / 2, which squares the error.
template <class T>
constexpr Mat3T<T> orthonormalized(const Mat3T<T>& R) {
  const T xx = dot(R.cx, R.cx), yy = dot(R.cy, R.cy), zz = dot(R.cz, R.cz);
  const T xy = T(0.5) * dot(R.cx, R.cy), yz = T(0.5) * dot(R.cy, R.cz),
          zx = T(0.5) * dot(R.cz, R.cx);
  const T half = T(0.5), k = T(1.5);
  return {(k - half * xx) * R.cx - xy * R.cy - zx * R.cz,
          (k - half * yy) * R.cy - yz * R.cz - xy * R.cx,
          (k - half * zz) * R.cz - zx * R.cx - yz * R.cy};
}

// The rotation at fraction s from A to B, along the shorter rotation, at a constant rate.
template <class T>
SO3T<T> interpolate(const SO3T<T>& A, const SO3T<T>& B, const std::type_identity_t<T>& s) {
  return A * Exp(s * Log(Inv(A) * B));
}

using SO3 = SO3T<double>;
using Quaternion = QuaternionT<double>;

}  // namespace vp
