// Logarithm and exponential from basic operations only, with the same bits on every machine. The
// standard library's results differ between machines, and a search continued elsewhere would draw
// other samples. Error within 4 ulp (plain_math_test).
#pragma once

#include <cmath>
#include <numbers>

namespace match {

// ln x = e ln 2 + 2 atanh((m - 1) / (m + 1)), x = 2^e m, sqrt(1/2) <= m < sqrt(2).
// Precondition: x is positive, normal and finite.
inline double plain_log(double x) {
  int exponent = 0;
  double m = std::frexp(x, &exponent);  // exact
  if (m < 0.5 * std::numbers::sqrt2) {
    m *= 2.0;
    --exponent;
  }
  const double s = (m - 1.0) / (m + 1.0), square = s * s;  // |s| < 0.172
  double sum = 0.0;
  for (int n = 23; n >= 3; n -= 2) sum = sum * square + 1.0 / n;
  return exponent * std::numbers::ln2 + (2.0 * s + 2.0 * s * square * sum);
}

// e^x = 2^k e^r, |r| <= ln 2 / 2. Precondition: |x| < 700.
inline double plain_exp(double x) {
  constexpr double kHigh = 0x1.62e42fee00000p-1, kLow = 0x1.a39ef35793c76p-33;  // of ln 2
  const double k = std::floor(x / std::numbers::ln2 + 0.5);
  const double r = (x - k * kHigh) - k * kLow;
  double sum = 1.0;
  for (int n = 15; n >= 1; --n) sum = 1.0 + sum * r / n;
  return std::ldexp(sum, static_cast<int>(k));  // exact
}

}  // namespace match
