// Dual numbers: a value and its derivatives along N directions, exact to rounding.
//
//   f(a + e b) = f(a) + e f'(a) b,  e^2 = 0
//
// A function of the Lie groups, called with dual scalars, returns its derivative beside its value.
// Comparisons use the values only.
#pragma once

#include <array>
#include <type_traits>

#include "vphysics/lie/scalar.h"

namespace vp {

template <class T, int N = 1>
struct DualT {
  T value{};
  std::array<T, N> derivative{};

  constexpr DualT() = default;
  constexpr DualT(const T& v) : value(v) {}
  template <class S>
  requires(std::is_arithmetic_v<S> && !std::is_same_v<S, T>) constexpr DualT(S s)
      : value(static_cast<T>(s)) {}
  // An independent variable: derivative 1 in one direction.
  static constexpr DualT variable(const T& v, int direction = 0) {
    DualT out(v);
    out.derivative[static_cast<std::size_t>(direction)] = T(1);
    return out;
  }

  friend constexpr DualT operator-(const DualT& a) {
    return a.chain(
        -a.value, [](const T&, const T& s) { return -s; }, a);
  }
  friend constexpr DualT operator+(const DualT& a, const DualT& b) {
    return a.chain(
        a.value + b.value, [](const T& x, const T& y) { return x + y; }, b);
  }
  friend constexpr DualT operator-(const DualT& a, const DualT& b) {
    return a.chain(
        a.value - b.value, [](const T& x, const T& y) { return x - y; }, b);
  }
  friend constexpr DualT operator*(const DualT& a, const DualT& b) {
    return a.chain(
        a.value * b.value, [&](const T& x, const T& y) { return a.value * y + b.value * x; }, b);
  }
  friend constexpr DualT operator/(const DualT& a, const DualT& b) {
    const T q = a.value / b.value;
    return a.chain(
        q, [&](const T& x, const T& y) { return (x - q * y) / b.value; }, b);
  }
  constexpr DualT& operator+=(const DualT& b) { return *this = *this + b; }
  constexpr DualT& operator-=(const DualT& b) { return *this = *this - b; }
  constexpr DualT& operator*=(const DualT& b) { return *this = *this * b; }

  friend constexpr auto operator<(const DualT& a, const DualT& b) { return a.value < b.value; }
  friend constexpr auto operator>(const DualT& a, const DualT& b) { return a.value > b.value; }
  friend constexpr auto operator<=(const DualT& a, const DualT& b) { return a.value <= b.value; }
  friend constexpr auto operator>=(const DualT& a, const DualT& b) { return a.value >= b.value; }
  friend constexpr auto operator==(const DualT& a, const DualT& b) { return a.value == b.value; }
  friend constexpr auto operator!=(const DualT& a, const DualT& b) { return a.value != b.value; }

  // A dual number with value v, whose derivatives are f of this number's and b's, one by one.
  template <class F>
  constexpr DualT chain(const T& v, const F& f, const DualT& b) const {
    DualT out(v);
    for (std::size_t i = 0; i < N; ++i) out.derivative[i] = f(derivative[i], b.derivative[i]);
    return out;
  }
  // f(this), given its value v and its derivative df.
  constexpr DualT through(const T& v, const T& df) const {
    return chain(
        v, [&](const T& x, const T&) { return df * x; }, *this);
  }
};

template <class T, int N>
struct BaseOf<DualT<T, N>> {
  using type = base_t<T>;
};

// Per lane, for dual numbers of packs.
template <class M, class T, int N>
requires(!std::is_same_v<M, bool>) constexpr DualT<T, N> select(const M& m, const DualT<T, N>& a,
                                                                const DualT<T, N>& b) {
  return a.chain(
      select(m, a.value, b.value), [&](const T& x, const T& y) { return select(m, x, y); }, b);
}
// Precondition: a > 0; the square root has no derivative at 0.
template <class T, int N>
DualT<T, N> sqrt(const DualT<T, N>& a) {
  using std::sqrt;
  const T root = sqrt(a.value);
  return a.through(root, T(0.5) / root);
}
template <class T, int N>
SinCosT<DualT<T, N>> sin_cos(const DualT<T, N>& x) {
  const auto [s, c] = sin_cos(x.value);
  return {x.through(s, c), x.through(c, -s)};
}
// Precondition: not both 0.
template <class T, int N>
DualT<T, N> arc_tangent(const DualT<T, N>& y, const DualT<T, N>& x) {
  const T r2 = x.value * x.value + y.value * y.value;
  return y.chain(
      arc_tangent(y.value, x.value),
      [&](const T& dy, const T& dx) { return (x.value * dy - y.value * dx) / r2; }, x);
}

}  // namespace vp
