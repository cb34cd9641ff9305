// N states at once: a scalar of N SIMD lanes, with the vector types of g++ and clang++.
//
// Each lane gives the same bits as the plain scalar. The width is independent of the target: 4
// lanes of double are one AVX register or two SSE2 registers.
#pragma once

#include <cstring>
#include <type_traits>

#include "vphysics/lie/scalar.h"

// Packs are passed between functions of one build, never between libraries built for different
// targets.
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wpsabi"

namespace vp {

namespace detail {
template <int BYTES>
using LaneMask = std::conditional_t<BYTES == 8, long long, int>;
}

// The result of a comparison: all bits of a lane set, or none.
template <class T, int N>
struct PackMaskT {
  // g++ drops the attribute of a dependent `using`.
  // NOLINTNEXTLINE(modernize-use-using)
  typedef detail::LaneMask<sizeof(T)> Lanes __attribute__((vector_size(sizeof(T) * N)));
  Lanes lanes;

  friend PackMaskT operator!(const PackMaskT& a) { return {~a.lanes}; }
};
template <class T, int N>
PackMaskT<T, N> both(const PackMaskT<T, N>& a, const PackMaskT<T, N>& b) {
  return {a.lanes & b.lanes};
}
template <class T, int N>
bool all(const PackMaskT<T, N>& m) {
  constexpr int kWords = static_cast<int>(sizeof m.lanes / sizeof(long long));
  long long words[kWords];
  std::memcpy(words, &m.lanes, sizeof words);
  for (int half = kWords / 2; half > 0; half /= 2) {
    for (int i = 0; i < half; ++i) words[i] &= words[i + half];
  }
  return words[0] == -1;
}
template <class T, int N>
bool none(const PackMaskT<T, N>& m) {
  return all(!m);
}

// Aligned to its size on every target, so that code for a target with wider registers may read it.
template <class T, int N>
struct alignas(sizeof(T) * N) PackT {
  static_assert(std::is_floating_point_v<T> && (N & (N - 1)) == 0);
  // NOLINTNEXTLINE(modernize-use-using)
  typedef T Lanes __attribute__((vector_size(sizeof(T) * N)));
  using Mask = PackMaskT<T, N>;
  static constexpr int kLanes = N;

  PackT() : lanes{} {}
  PackT(const Lanes& l) : lanes(l) {}
  // Broadcasts a number to all lanes.
  template <class S>
  requires std::is_arithmetic_v<S> PackT(S s) {
    lanes = static_cast<T>(s) - Lanes{};  // broadcast; zeros keep their sign
  }

  T operator[](int lane) const { return lanes[lane]; }
  void set(int lane, T value) { lanes[lane] = value; }

  friend PackT operator+(const PackT& a, const PackT& b) { return a.lanes + b.lanes; }
  friend PackT operator-(const PackT& a, const PackT& b) { return a.lanes - b.lanes; }
  friend PackT operator*(const PackT& a, const PackT& b) { return a.lanes * b.lanes; }
  friend PackT operator/(const PackT& a, const PackT& b) { return a.lanes / b.lanes; }
  friend PackT operator-(const PackT& a) { return -a.lanes; }
  PackT& operator+=(const PackT& b) { return *this = *this + b; }
  PackT& operator-=(const PackT& b) { return *this = *this - b; }
  PackT& operator*=(const PackT& b) { return *this = *this * b; }

  friend Mask operator<(const PackT& a, const PackT& b) { return {a.lanes < b.lanes}; }
  friend Mask operator>(const PackT& a, const PackT& b) { return {a.lanes > b.lanes}; }
  friend Mask operator<=(const PackT& a, const PackT& b) { return {a.lanes <= b.lanes}; }
  friend Mask operator>=(const PackT& a, const PackT& b) { return {a.lanes >= b.lanes}; }
  friend Mask operator==(const PackT& a, const PackT& b) { return {a.lanes == b.lanes}; }
  friend Mask operator!=(const PackT& a, const PackT& b) { return {a.lanes != b.lanes}; }

  Lanes lanes;
};

template <class T, int N>
struct BaseOf<PackT<T, N>> {
  using type = T;
};

template <class T, int N>
PackT<T, N> select(const PackMaskT<T, N>& m, const PackT<T, N>& a, const PackT<T, N>& b) {
  return PackT<T, N>(m.lanes ? a.lanes : b.lanes);
}
template <class T, int N, class F, class G>
auto choose(const PackMaskT<T, N>& m, const F& f, const G& g) {
  if (all(m)) return f();
  if (none(m)) return g();
  return select(m, f(), g());
}

template <class T, int N>
PackT<T, N> sqrt(const PackT<T, N>& a) {
  PackT<T, N> out;
  for (int i = 0; i < N; ++i) out.lanes[i] = std::sqrt(a.lanes[i]);
  return out;
}
template <class T, int N>
SinCosT<PackT<T, N>> sin_cos(const PackT<T, N>& x) {
  const PackT<T, N> limit = detail::Angle<T>::kExactBelow;
  if (all(both(x < limit, -x < limit))) return detail::sin_cos_near(x);
  SinCosT<PackT<T, N>> out;
  for (int i = 0; i < N; ++i) {
    const auto [s, c] = sin_cos(x[i]);
    out.sin.set(i, s);
    out.cos.set(i, c);
  }
  return out;
}
template <class T, int N>
PackT<T, N> arc_tangent(const PackT<T, N>& y, const PackT<T, N>& x) {
  PackT<T, N> out;
  for (int i = 0; i < N; ++i) out.set(i, arc_tangent(y[i], x[i]));
  return out;
}

}  // namespace vp

#pragma GCC diagnostic pop
