// Elementary functions whose result feeds the state of a simulation.
//
// libm's sin, cos and atan2 differ in the last bit between libraries (glibc, musl, emscripten), and
// a simulation that must be the same to the bit cannot use them. These use only IEEE 754 operations
// that are exact or correctly rounded (+ - * / sqrt floor fmod), so that they give the same bits
// wherever contraction is off. Accuracy: within 2 units in the last place for |x| < 2^20.
#pragma once

#include <cmath>
#include <limits>

namespace vp {

inline constexpr double kPi = 3.141592653589793;

template <class T>
struct SinCosT {
  T sin, cos;
};

namespace detail {

// pi/2 in three parts: the first two have 33 bits, so that n * part is exact for |n| < 2^20.
inline constexpr double kHalfPi1 = 1.57079632673412561417e+00;
inline constexpr double kHalfPi2 = 6.07710050630396597660e-11;
inline constexpr double kHalfPi3 = 2.02226624879595063154e-21;

// Taylor polynomials on |r| <= pi/4: the first term left out is below 8e-20 (sin) and 2e-18 (cos).
inline constexpr double sin_kernel(double r) {
  const double z = r * r;
  double s = 1.0 / 355687428096000.0;
  s = s * z - 1.0 / 1307674368000.0;
  s = s * z + 1.0 / 6227020800.0;
  s = s * z - 1.0 / 39916800.0;
  s = s * z + 1.0 / 362880.0;
  s = s * z - 1.0 / 5040.0;
  s = s * z + 1.0 / 120.0;
  s = s * z - 1.0 / 6.0;
  return r + r * z * s;
}

inline constexpr double cos_kernel(double r) {
  const double z = r * r;
  double c = 1.0 / 20922789888000.0;
  c = c * z - 1.0 / 87178291200.0;
  c = c * z + 1.0 / 479001600.0;
  c = c * z - 1.0 / 3628800.0;
  c = c * z + 1.0 / 40320.0;
  c = c * z - 1.0 / 720.0;
  c = c * z + 1.0 / 24.0;
  return 1.0 - (0.5 * z - z * z * c);
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
// argument of the series is at most 1/16 and the first term left out below 6e-20.
inline double atan_unit(double x) {
  const int k = static_cast<int>(std::floor(x * 8.0 + 0.5));
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

// Sine and cosine of x [rad]; finite x. Beyond 2^20 the angle is first taken modulo the double
// nearest to 2 pi: still deterministic, with an absolute error that grows as 4e-17 |x|.
inline SinCosT<double> sin_cos(double x) {
  constexpr double kExactBelow = 1048576.0;
  if (!(std::fabs(x) < kExactBelow)) x = std::fmod(x, 2.0 * kPi);
  const double n = std::floor(x * (2.0 / kPi) + 0.5);
  const double r = ((x - n * detail::kHalfPi1) - n * detail::kHalfPi2) - n * detail::kHalfPi3;
  const double s = detail::sin_kernel(r);
  const double c = detail::cos_kernel(r);
  switch (static_cast<int>(n - 4.0 * std::floor(n * 0.25))) {
    case 0:
      return {s, c};
    case 1:
      return {c, -s};
    case 2:
      return {-s, -c};
    default:
      return {-c, s};
  }
}

inline SinCosT<float> sin_cos(float x) {
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
