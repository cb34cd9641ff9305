// The operations that the Lie groups need of a scalar: + - * /, comparisons, sqrt, sin_cos,
// arc_tangent, and the selection of one of two formulas. This file has double and float. A counting
// scalar is in count.h, a dual number in dual.h, a pack of SIMD lanes in pack.h.
//
// libm's sin, cos and atan2 differ in the last bit between libraries (glibc, musl, emscripten), so
// a simulation that must be reproducible to the bit cannot use them. The functions here use only
// IEEE 754 operations that are exact or correctly rounded (+ - * / sqrt floor fmod). They give the
// same bits wherever contraction is off, also in each lane of a pack.
#pragma once

#include <cmath>
#include <limits>

namespace vp {

inline constexpr double kPi = 3.141592653589793;

template <class T>
struct SinCosT {
  T sin, cos;
};

// The floating-point type of a scalar's values: of a pack's lanes, of a dual number's value.
template <class T>
struct BaseOf {
  using type = T;
};
template <class T>
using base_t = typename BaseOf<T>::type;

// Conditions of a single state; packs overload them.
constexpr bool all(bool condition) {
  return condition;
}
constexpr bool both(bool a, bool b) {
  return a && b;
}
// Selects one of two formulas by a condition. A single state evaluates only the selected formula. A
// pack evaluates both where its lanes differ, so each must be safe to evaluate outside its range.
template <class F, class G>
constexpr auto choose(bool condition, const F& f, const G& g) {
  return condition ? f() : g();
}
// Selects one of two values.
template <class T>
constexpr T select(bool condition, const T& a, const T& b) {
  return condition ? a : b;
}

namespace detail {

// pi/2 in three parts; the first two have so few bits that n * part is exact. Adding and
// subtracting 1.5 * 2^(mantissa bits) rounds to an integer.
template <class T>
struct Angle;
template <>
struct Angle<double> {
  static constexpr double kHalfPi1 = 1.57079632673412561417e+00;  // 33 bits
  static constexpr double kHalfPi2 = 6.07710050630396597660e-11;  // 33 bits
  static constexpr double kHalfPi3 = 2.02226624879595063154e-21;
  static constexpr double kRounder = 6755399441055744.0;
  static constexpr double kExactBelow = 1048576.0;
};
template <>
struct Angle<float> {
  static constexpr float kHalfPi1 = 1.5703125f;                // 11 bits
  static constexpr float kHalfPi2 = 4.837512969970703125e-4f;  // 11 bits
  static constexpr float kHalfPi3 = 7.549790e-8f;
  static constexpr float kRounder = 12582912.0f;
  static constexpr float kExactBelow = 4096.0f;
};

// Taylor polynomials on |r| <= pi/4 by Estrin's scheme: four short chains of operations instead of
// one long chain. In double the first omitted term is below 8e-20 (sin) and 2e-18 (cos), in float
// 2e-9 and 2e-10.
template <class T>
constexpr SinCosT<T> sin_cos_kernel(const T& r, double) {
  const T z = r * r, z2 = z * z, z4 = z2 * z2;
  const T s =
      ((T(-1.0 / 6.0) + z * T(1.0 / 120.0)) + z2 * (T(-1.0 / 5040.0) + z * T(1.0 / 362880.0))) +
      z4 * ((T(-1.0 / 39916800.0) + z * T(1.0 / 6227020800.0)) +
            z2 * (T(-1.0 / 1307674368000.0) + z * T(1.0 / 355687428096000.0)));
  const T c =
      ((T(1.0 / 24.0) - z * T(1.0 / 720.0)) + z2 * (T(1.0 / 40320.0) - z * T(1.0 / 3628800.0))) +
      z4 * ((T(1.0 / 479001600.0) - z * T(1.0 / 87178291200.0)) + z2 * T(1.0 / 20922789888000.0));
  return {r + (r * z) * s, T(1.0) - (T(0.5) * z - z2 * c)};
}
template <class T>
constexpr SinCosT<T> sin_cos_kernel(const T& r, float) {
  const T z = r * r, z2 = z * z;
  const T s = (T(-1.0f / 6.0f) + z * T(1.0f / 120.0f)) +
              z2 * (T(-1.0f / 5040.0f) + z * T(1.0f / 362880.0f));
  const T c = (T(1.0f / 24.0f) - z * T(1.0f / 720.0f)) +
              z2 * (T(1.0f / 40320.0f) - z * T(1.0f / 3628800.0f));
  return {r + (r * z) * s, T(1.0f) - (T(0.5f) * z - z2 * c)};
}

template <class T>
constexpr T nearest_integer(const T& x) {
  return (x + T(Angle<base_t<T>>::kRounder)) - T(Angle<base_t<T>>::kRounder);
}

// |x| < kExactBelow. Branch-free, so that packs can use it: the parities of n and of floor(n / 2)
// give the quadrant n mod 4.
template <class T>
constexpr SinCosT<T> sin_cos_near(const T& x) {
  using B = base_t<T>;
  const T n = nearest_integer(x * T(B(2.0 / kPi)));
  const T r =
      ((x - n * T(Angle<B>::kHalfPi1)) - n * T(Angle<B>::kHalfPi2)) - n * T(Angle<B>::kHalfPi3);
  const auto [s, c] = sin_cos_kernel(r, B());
  const T half = n * T(B(0.5));
  const T rounded = nearest_integer(half);
  const auto odd = half != rounded;
  const T below = select(rounded > half, rounded - T(B(1)), rounded);  // floor(n / 2)
  const T quarter = below * T(B(0.5));
  const auto flip = quarter != nearest_integer(quarter);
  const T sine = select(odd, c, s), cosine = select(odd, -s, c);
  return {select(flip, -sine, sine), select(flip, -cosine, cosine)};
}

// atan(k / 8)
inline constexpr double kAtanTable[9] = {0.0,
                                         0.12435499454676144,
                                         0.24497866312686414,
                                         0.35877067027057225,
                                         0.46364760900080609,
                                         0.55859931534356244,
                                         0.64350110879328437,
                                         0.71882999962162453,
                                         0.78539816339744828};

// 0 <= x <= 1. atan x = atan c + atan((x - c) / (1 + x c)), c the nearest eighth, so that the
// argument of the series is at most 1/16 and the first omitted term is below 6e-20. NaN gives NaN.
inline double atan_unit(double x) {
  const int k = x <= 1.0 ? static_cast<int>(std::floor(x * 8.0 + 0.5)) : 0;
  const double c = k * 0.125;
  const double t = (x - c) / (1.0 + x * c);
  const double z = t * t;
  double s = 1.0 / 13.0;
  s = s * z - 1.0 / 11.0;
  s = s * z + 1.0 / 9.0;
  s = s * z - 1.0 / 7.0;
  s = s * z + 1.0 / 5.0;
  s = s * z - 1.0 / 3.0;
  return kAtanTable[k] + (t + t * z * s);
}

}  // namespace detail

// Sine and cosine of a finite x [rad]. Within 2 units in the last place for |x| < 2^20 (float:
// 4096). A larger angle is first reduced modulo the double nearest to 2 pi: still deterministic,
// with an absolute error that grows as 4e-17 |x|.
inline SinCosT<double> sin_cos(double x) {
  if (!(std::fabs(x) < detail::Angle<double>::kExactBelow)) x = std::fmod(x, 2.0 * kPi);
  return detail::sin_cos_near(x);
}
inline SinCosT<float> sin_cos(float x) {
  if (std::fabs(x) < detail::Angle<float>::kExactBelow) return detail::sin_cos_near(x);
  const auto [s, c] = sin_cos(static_cast<double>(x));
  return {static_cast<float>(s), static_cast<float>(c)};
}

// Angle of (x, y) from the x axis, in [-pi, pi]; atan2(0, 0) is 0.
inline double arc_tangent(double y, double x) {
  const double ay = std::fabs(y);
  const double ax = std::fabs(x);
  if (ax == 0.0 && ay == 0.0) return 0.0;
  double a = ay <= ax ? detail::atan_unit(ay / ax) : 0.5 * kPi - detail::atan_unit(ax / ay);
  if (x < 0.0) a = kPi - a;
  return y < 0.0 ? -a : a;
}

inline float arc_tangent(float y, float x) {
  return static_cast<float>(arc_tangent(static_cast<double>(y), static_cast<double>(x)));
}

}  // namespace vp
