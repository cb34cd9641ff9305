// AABBs in single precision, rounded outward, and eight of them in structure-of-arrays layout.
//
// Four float lanes are one register on SSE2, NEON and WebAssembly. Only comparisons, minima and
// maxima operate on them, so every target gives the same bits.
#pragma once

#include <array>
#include <bit>
#include <cstdint>
#include <limits>

#include "collide/bounds.h"
#ifdef __SSE2__
#include <emmintrin.h>
#endif

namespace vp::collide {

// NOLINTNEXTLINE(modernize-use-using): g++ drops the attribute of a `using` in places
typedef float Lanes4 __attribute__((vector_size(16)));
// NOLINTNEXTLINE(modernize-use-using)
typedef int Mask4 __attribute__((vector_size(16)));

inline Lanes4 broadcast(float x) {
  return Lanes4{x, x, x, x};
}
inline Lanes4 lesser(Lanes4 a, Lanes4 b) {
  return a < b ? a : b;
}
inline Lanes4 greater(Lanes4 a, Lanes4 b) {
  return a > b ? a : b;
}
// Bit i: lane i of a comparison result.
inline unsigned bits_of(Mask4 m) {
#ifdef __SSE2__
  return static_cast<unsigned>(_mm_movemask_ps(reinterpret_cast<__m128>(m)));
#else
  const Mask4 b = m & Mask4{1, 2, 4, 8};
  return static_cast<unsigned>((b[0] | b[1]) | (b[2] | b[3]));
#endif
}

// x, y, z and an unused lane.
struct FloatBounds {
  Lanes4 lower = broadcast(std::numeric_limits<float>::infinity());
  Lanes4 upper = broadcast(-std::numeric_limits<float>::infinity());

  bool operator==(const FloatBounds& b) const {
    return (bits_of((lower == b.lower) & (upper == b.upper)) & 7u) == 7u;
  }
};

inline bool overlap(const FloatBounds& a, const FloatBounds& b) {
  return (bits_of((a.lower <= b.upper) & (b.lower <= a.upper)) & 7u) == 7u;
}
inline bool contains(const FloatBounds& outer, const FloatBounds& inner) {
  return (bits_of((outer.lower <= inner.lower) & (inner.upper <= outer.upper)) & 7u) == 7u;
}
inline FloatBounds merged(const FloatBounds& a, const FloatBounds& b) {
  return {lesser(a.lower, b.lower), greater(a.upper, b.upper)};
}
// Half the surface area; 0 for empty bounds.
inline float half_area(const FloatBounds& a) {
  const Lanes4 d = greater(a.upper - a.lower, Lanes4{});
  return d[0] * d[1] + d[1] * d[2] + d[2] * d[0];
}

// Coordinates beyond this [m] are clamped to it: sums and products of bounds are never NaN.
inline constexpr double kFloatFar = 1e15;

// A float at most x, and at most 2^-23 of it below: subtracts half of that before rounding to
// nearest. Without the last term a number slightly below zero would become zero.
inline float rounded_down(double x) {
  const double in_range = std::min(std::max(x, -kFloatFar), kFloatFar);
  return static_cast<float>(in_range - (std::fabs(in_range) * (0x1p-24 * 1.000001) + 1e-37));
}
inline float rounded_up(double x) {
  return -rounded_down(-x);
}
inline FloatBounds rounded_outward(const Bounds& b) {
  return {Lanes4{rounded_down(b.lower.x), rounded_down(b.lower.y), rounded_down(b.lower.z), 0.0f},
          Lanes4{rounded_up(b.upper.x), rounded_up(b.upper.y), rounded_up(b.upper.z), 0.0f}};
}
inline Bounds widened(const FloatBounds& b) {
  return {{b.lower[0], b.lower[1], b.lower[2]}, {b.upper[0], b.upper[1], b.upper[2]}};
}

// PaddedSix bounds as a structure of arrays; unused lanes are empty and overlap nothing.
struct EightBounds {
  Lanes4 lower[3][2];
  Lanes4 upper[3][2];

  FloatBounds lane(unsigned i) const {
    const unsigned h = i / 4, k = i % 4;
    return {Lanes4{lower[0][h][k], lower[1][h][k], lower[2][h][k], 0.0f},
            Lanes4{upper[0][h][k], upper[1][h][k], upper[2][h][k], 0.0f}};
  }
  void set_lane(unsigned i, const FloatBounds& b) {
    const unsigned h = i / 4, k = i % 4;
    for (int axis = 0; axis < 3; ++axis) {
      lower[axis][h][k] = b.lower[axis];
      upper[axis][h][k] = b.upper[axis];
    }
  }
};

// One box in all lanes.
struct SpreadBounds {
  Lanes4 lower[3], upper[3];
  explicit SpreadBounds(const FloatBounds& b) {
    for (int axis = 0; axis < 3; ++axis) {
      lower[axis] = broadcast(b.lower[axis]);
      upper[axis] = broadcast(b.upper[axis]);
    }
  }
  SpreadBounds(const EightBounds& eight, unsigned lane) {
    for (int axis = 0; axis < 3; ++axis) {
      lower[axis] = broadcast(eight.lower[axis][lane / 4][lane % 4]);
      upper[axis] = broadcast(eight.upper[axis][lane / 4][lane % 4]);
    }
  }
};

// Bit i: lane i overlaps the box.
inline unsigned overlap_mask(const EightBounds& eight, const SpreadBounds& box) {
  unsigned bits = 0;
  for (unsigned h = 0; h < 2; ++h) {
    const Mask4 x = (eight.lower[0][h] <= box.upper[0]) & (box.lower[0] <= eight.upper[0][h]);
    const Mask4 y = (eight.lower[1][h] <= box.upper[1]) & (box.lower[1] <= eight.upper[1][h]);
    const Mask4 z = (eight.lower[2][h] <= box.upper[2]) & (box.lower[2] <= eight.upper[2][h]);
    bits |= bits_of(x & y & z) << (4 * h);
  }
  return bits;
}

// Calls f(i) for each set bit, in ascending order.
template <class F>
void for_each_bit(std::uint64_t bits, const F& f) {
  for (; bits != 0; bits &= bits - 1) f(static_cast<unsigned>(std::countr_zero(bits)));
}

// By byte: the positions of the set bits, then zeros; and the number of set bits.
struct BitPositions {
  std::array<std::array<std::uint8_t, 8>, 256> of{};
  std::array<std::uint8_t, 256> count{};
  constexpr BitPositions() {
    for (unsigned byte = 0; byte < 256; ++byte) {
      std::size_t n = 0;
      for (unsigned i = 0; i < 8; ++i) {
        if ((byte >> i) & 1u) of[byte][n++] = static_cast<std::uint8_t>(i);
      }
      count[byte] = static_cast<std::uint8_t>(n);
    }
  }
};
inline constexpr BitPositions kBitPositions;

// Appends the children whose bit is set, combined with the upper half of the word, and returns
// their number. Always writes eight words: their number is unpredictable, so a loop over the bits
// would cost more. With out of std::uint32_t the upper half is dropped.
template <class Word>
std::size_t append_chosen(unsigned bits, const std::uint32_t child[8], std::uint64_t upper,
                          Word* out) {
  const std::array<std::uint8_t, 8>& positions = kBitPositions.of[bits];
  for (std::size_t k = 0; k < 8; ++k) out[k] = static_cast<Word>(upper | child[positions[k]]);
  return kBitPositions.count[bits];
}

}  // namespace vp::collide
