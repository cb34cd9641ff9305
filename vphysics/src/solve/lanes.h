// Gathers the states of bodies into SIMD lanes and scatters them back, so that W contacts of W
// disjoint pairs of bodies are solved in parallel.
//
// A body's numbers are contiguous: a row of a matrix. A lane of a pack is a body. Gathering W
// bodies is a transposition of W rows. Lanes do not interact, and no operations are contracted:
// every W gives the same bits.
#pragma once

#include <cstdint>
#include <utility>

#if defined(__SSE2__)
#include <immintrin.h>
#endif

#include "vphysics/lie/inertia.h"
#include "vphysics/lie/pack.h"

namespace vp::solve {

template <int W>
using Lanes = PackT<float, W>;
template <int W>
using LaneMask = PackMaskT<float, W>;

namespace lanes {

// One bit per lane.
template <int W>
unsigned bits_of(const LaneMask<W>& m) {
#if defined(__AVX512DQ__)
  if constexpr (W == 16) return _mm512_movepi32_mask(reinterpret_cast<__m512i>(m.lanes));
#endif
#if defined(__AVX__)
  if constexpr (W == 8) {
    return static_cast<unsigned>(_mm256_movemask_ps(reinterpret_cast<__m256>(m.lanes)));
  }
#endif
#if defined(__SSE2__)
  if constexpr (W == 4) {
    return static_cast<unsigned>(_mm_movemask_ps(reinterpret_cast<__m128>(m.lanes)));
  }
#endif
  unsigned bits = 0;
  for (int i = 0; i < W; ++i) bits |= (m.lanes[i] != 0 ? 1u : 0u) << i;
  return bits;
}
template <int W>
inline constexpr unsigned kAllBits = (1u << W) - 1u;

// g++ drops the attribute of a dependent `using`.
template <int N>
struct Raw {
  // NOLINTNEXTLINE(modernize-use-using)
  typedef float Type __attribute__((vector_size(sizeof(float) * N)));
};
template <int N>
using RawT = typename Raw<N>::Type;

template <int N>
RawT<N> load(const float* p) {
  RawT<N> r;
  __builtin_memcpy(&r, __builtin_assume_aligned(p, sizeof r), sizeof r);
  return r;
}
template <int N>
void store(float* p, const RawT<N>& r) {
  __builtin_memcpy(__builtin_assume_aligned(p, sizeof r), &r, sizeof r);
}

// One stage of a transposition of groups of 2 k lanes: alternates blocks of k lanes of a and b.
template <int W, int K, std::size_t... I>
RawT<W> mix_low(const RawT<W>& a, const RawT<W>& b, std::index_sequence<I...>) {
  return __builtin_shufflevector(a, b, ((I / K) % 2 == 0 ? I : I - K + W)...);
}
template <int W, int K, std::size_t... I>
RawT<W> mix_high(const RawT<W>& a, const RawT<W>& b, std::index_sequence<I...>) {
  return __builtin_shufflevector(a, b, ((I / K) % 2 == 0 ? I + K : I + W)...);
}

// Transposes every group of N lanes of N rows: lane g N + j of row i becomes lane g N + i of row j.
template <int W, int N, int K = 1>
void transpose(RawT<W>* r) {
  constexpr auto kAll = std::make_index_sequence<W>();
  for (int i = 0; i < N; ++i) {
    if ((i / K) % 2 != 0) continue;
    const RawT<W> a = r[i], b = r[i + K];
    r[i] = mix_low<W, K>(a, b, kAll);
    r[i + K] = mix_high<W, K>(a, b, kAll);
  }
  if constexpr (2 * K < N) transpose<W, N, 2 * K>(r);
}

template <std::size_t... I>
RawT<16> joined(const RawT<8>& a, const RawT<8>& b, std::index_sequence<I...>) {
  return __builtin_shufflevector(a, b, I...);
}
template <int FROM, std::size_t... I>
RawT<8> half(const RawT<16>& a, std::index_sequence<I...>) {
  return __builtin_shufflevector(a, a, (I + FROM)...);
}

// Loads 8 floats of each of W rows as 8 packs. p(i) is the address of row i, aligned to 32 bytes.
template <int W, class Row>
void gather8(const Row& p, Lanes<W>* out) {
  if constexpr (W == 16) {
    RawT<16> r[8];
    for (int i = 0; i < 8; ++i) {
      r[i] = joined(load<8>(p(i)), load<8>(p(i + 8)), std::make_index_sequence<16>());
    }
    transpose<16, 8>(r);
    for (int i = 0; i < 8; ++i) out[i] = Lanes<W>(r[i]);
  } else {
    for (int c = 0; c < 8; c += W) {
      RawT<W> r[W];
      for (int i = 0; i < W; ++i) r[i] = load<W>(p(i) + c);
      transpose<W, W>(r);
      for (int i = 0; i < W; ++i) out[c + i] = Lanes<W>(r[i]);
    }
  }
}
// Stores the rows for which keep(i) is true.
template <int W, class Row, class Keep>
void scatter8(const Row& p, const Lanes<W>* in, const Keep& keep) {
  if constexpr (W == 16) {
    RawT<16> r[8];
    for (int i = 0; i < 8; ++i) r[i] = in[i].lanes;
    transpose<16, 8>(r);
    for (int i = 0; i < 8; ++i) {
      if (keep(i)) store<8>(p(i), half<0>(r[i], std::make_index_sequence<8>()));
      if (keep(i + 8)) store<8>(p(i + 8), half<8>(r[i], std::make_index_sequence<8>()));
    }
  } else {
    for (int c = 0; c < 8; c += W) {
      RawT<W> r[W];
      for (int i = 0; i < W; ++i) r[i] = in[c + i].lanes;
      transpose<W, W>(r);
      for (int i = 0; i < W; ++i) {
        if (keep(i)) store<W>(p(i) + c, r[i]);
      }
    }
  }
}
// Loads 16 floats of each row, aligned to 64 bytes.
template <int W, class Row>
void gather16(const Row& p, Lanes<W>* out) {
  if constexpr (W == 16) {
    RawT<16> r[16];
    for (int i = 0; i < 16; ++i) r[i] = load<16>(p(i));
    transpose<16, 16>(r);
    for (int i = 0; i < 16; ++i) out[i] = Lanes<W>(r[i]);
  } else {
    gather8<W>(p, out);
    gather8<W>([&](int i) { return p(i) + 8; }, out + 8);
  }
}

}  // namespace lanes

// As the generic functions of packs, with fewer instructions.
template <int W>
bool none(const LaneMask<W>& m) {
  return lanes::bits_of(m) == 0u;
}
template <int W>
bool all(const LaneMask<W>& m) {
  return lanes::bits_of(m) == lanes::kAllBits<W>;
}
template <int W>
LaneMask<W> either(const LaneMask<W>& a, const LaneMask<W>& b) {
  return {a.lanes | b.lanes};
}

// a > b ? a : b and a < b ? a : b. So they return b if the two are equal or unordered. g++
// generates two instructions instead of the single one if one operand is a constant.
template <int W>
Lanes<W> larger(const Lanes<W>& a, const Lanes<W>& b) {
#if defined(__AVX512F__)
  if constexpr (W == 16) return Lanes<W>(_mm512_maskz_max_ps(0xffff, a.lanes, b.lanes));
#endif
#if defined(__AVX__)
  if constexpr (W == 8) return Lanes<W>(_mm256_max_ps(a.lanes, b.lanes));
#endif
  return select(a > b, a, b);
}
template <int W>
Lanes<W> smaller(const Lanes<W>& a, const Lanes<W>& b) {
#if defined(__AVX512F__)
  if constexpr (W == 16) return Lanes<W>(_mm512_maskz_min_ps(0xffff, a.lanes, b.lanes));
#endif
#if defined(__AVX__)
  if constexpr (W == 8) return Lanes<W>(_mm256_min_ps(a.lanes, b.lanes));
#endif
  return select(a < b, a, b);
}
// Clears the sign bit.
template <int W>
Lanes<W> abs(const Lanes<W>& x) {
  using Words = decltype(LaneMask<W>::lanes);
  return Lanes<W>(reinterpret_cast<lanes::RawT<W>>(reinterpret_cast<Words>(x.lanes) & 0x7fffffff));
}

}  // namespace vp::solve
