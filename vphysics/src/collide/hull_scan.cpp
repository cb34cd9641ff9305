#include "collide/hull_scan.h"

#include <algorithm>
#include <cstdint>
#include <cstring>

#include "collide/bounds.h"
#include "cpu_level.h"

namespace vp::collide {
namespace {

// Numbers in parallel. g++ 12 computes packs wider than the machine's registers number by number,
// so that each instruction set has its own width.
struct Four {
  using Numbers [[gnu::vector_size(32)]] = double;
  using Words [[gnu::vector_size(32)]] = std::int64_t;
  static constexpr std::size_t kWidth = 4;
  static constexpr Numbers kIndices = {0, 1, 2, 3};
  static constexpr Words kBits = {1, 2, 4, 8};
};
#ifdef VP_INSTRUCTION_SETS
struct Eight {
  using Numbers [[gnu::vector_size(64)]] = double;
  using Words [[gnu::vector_size(64)]] = std::int64_t;
  static constexpr std::size_t kWidth = 8;
  static constexpr Numbers kIndices = {0, 1, 2, 3, 4, 5, 6, 7};
  static constexpr Words kBits = {1, 2, 4, 8, 16, 32, 64, 128};
};
#endif

template <class Numbers>
[[gnu::always_inline]] inline void load(Numbers& to, const double* from) {
  std::memcpy(&to, from, sizeof to);
}

struct Largest {
  template <class V>
  [[gnu::always_inline]] static void take(V& x, const V& other) {
    x = other > x ? other : x;
  }
};
struct Smallest {
  template <class V>
  [[gnu::always_inline]] static void take(V& x, const V& other) {
    x = other < x ? other : x;
  }
};
struct AnyBit {
  template <class V>
  [[gnu::always_inline]] static void take(V& x, const V& other) {
    x |= other;
  }
};
// The result of all lanes into each.
template <class Op, class V>
[[gnu::always_inline]] inline void fold(V& x) {
  V other;
  if constexpr (sizeof(V) == 64) {
    other = __builtin_shufflevector(x, x, 4, 5, 6, 7, 0, 1, 2, 3);
    Op::take(x, other);
    other = __builtin_shufflevector(x, x, 2, 3, 0, 1, 6, 7, 4, 5);
    Op::take(x, other);
    other = __builtin_shufflevector(x, x, 1, 0, 3, 2, 5, 4, 7, 6);
    Op::take(x, other);
  } else {
    other = __builtin_shufflevector(x, x, 2, 3, 0, 1);
    Op::take(x, other);
    other = __builtin_shufflevector(x, x, 1, 0, 3, 2);
    Op::take(x, other);
  }
}

template <class P>
[[gnu::always_inline]] inline int scan_vectors(const ScanList& list, const Vec3& d) {
  using Numbers = typename P::Numbers;
  Numbers largest = Numbers{} - kFar, found{}, at = P::kIndices;
  for (std::size_t i = 0; i < list.x.size(); i += P::kWidth) {
    Numbers x, y, z;
    load(x, &list.x[i]);
    load(y, &list.y[i]);
    load(z, &list.z[i]);
    const Numbers along = d.x * x + d.y * y + d.z * z;
    const auto farther = along > largest;
    largest = farther ? along : largest;
    found = farther ? at : found;
    at += static_cast<double>(P::kWidth);
  }
  Numbers most = largest;
  fold<Largest>(most);
  Numbers first = largest == most ? found : Numbers{} + kFar;
  fold<Smallest>(first);
  return static_cast<int>(first[0]);
}

template <class P>
[[gnu::always_inline]] inline std::uint64_t scan_planes(const ScanPlanes& planes, std::size_t first,
                                                        const Vec3& p, const Vec3& q,
                                                        double distance) {
  using Numbers = typename P::Numbers;
  using Words = typename P::Words;
  Words found{}, bit = P::kBits;
  const std::size_t end = std::min(planes.offset.size(), first + kScanBits);
  for (std::size_t i = first; i < end; i += P::kWidth) {
    Numbers x, y, z, offset;
    load(x, &planes.normal.x[i]);
    load(y, &planes.normal.y[i]);
    load(z, &planes.normal.z[i]);
    load(offset, &planes.offset[i]);
    const Numbers of_p = (p.x * x + p.y * y + p.z * z) - offset;
    const Numbers of_q = (q.x * x + q.y * y + q.z * z) - offset;
    const Words behind_p = of_p > distance, behind_q = of_q > distance;
    found |= behind_p & behind_q & bit;
    bit <<= static_cast<int>(P::kWidth);
  }
  fold<AnyBit>(found);
  return static_cast<std::uint64_t>(found[0]);
}

template <class P>
[[gnu::always_inline]] inline std::uint64_t scan_between(const double* x, const double* y,
                                                         const double* z, std::size_t count,
                                                         const Vec3& p, const Vec3& q) {
  using Numbers = typename P::Numbers;
  using Words = typename P::Words;
  Words found{}, bit = P::kBits;
  for (std::size_t i = 0; i < count; i += P::kWidth) {
    Numbers vx, vy, vz;
    load(vx, x + i);
    load(vy, y + i);
    load(vz, z + i);
    const Numbers of_p = p.x * vx + p.y * vy + p.z * vz, of_q = q.x * vx + q.y * vy + q.z * vz;
    const Words between = of_p * of_q < 0.0;
    found |= between & bit;
    bit <<= static_cast<int>(P::kWidth);
  }
  fold<AnyBit>(found);
  return static_cast<std::uint64_t>(found[0]);
}

struct Scans {
  int (*vectors)(const ScanList&, const Vec3&);
  std::uint64_t (*planes)(const ScanPlanes&, std::size_t, const Vec3&, const Vec3&, double);
  std::uint64_t (*between)(const double*, const double*, const double*, std::size_t, const Vec3&,
                           const Vec3&);
};

// The three for one instruction set, to the same bits: nothing is fused. Planes are always scanned
// in fours: eight masks of two comparisons at a time are slower than four.
#define VP_SCANS(NAME, PACK, ...)                                                             \
  __VA_ARGS__ int vectors_##NAME(const ScanList& list, const Vec3& d) {                       \
    return scan_vectors<PACK>(list, d);                                                       \
  }                                                                                           \
  __VA_ARGS__ std::uint64_t planes_##NAME(const ScanPlanes& planes, std::size_t first,        \
                                          const Vec3& p, const Vec3& q, double distance) {    \
    return scan_planes<Four>(planes, first, p, q, distance);                                  \
  }                                                                                           \
  __VA_ARGS__ std::uint64_t between_##NAME(const double* x, const double* y, const double* z, \
                                           std::size_t count, const Vec3& p, const Vec3& q) { \
    return scan_between<PACK>(x, y, z, count, p, q);                                          \
  }                                                                                           \
  constexpr Scans k_##NAME = {vectors_##NAME, planes_##NAME, between_##NAME};

VP_SCANS(baseline, Four)
#ifdef VP_INSTRUCTION_SETS
VP_SCANS(avx2, Four, [[gnu::target("avx2")]])
VP_SCANS(avx512, Eight, [[gnu::target("avx512f,avx512vl,avx512dq,avx512bw")]])
#endif
#undef VP_SCANS

Scans scans_of_this_machine() {
#ifdef VP_INSTRUCTION_SETS
  const CpuLevel level = cpu_level();
  if (level == CpuLevel::avx512) return k_avx512;
  if (level == CpuLevel::avx2) return k_avx2;
#endif
  return k_baseline;
}

const Scans& scans() {
  static const Scans chosen = scans_of_this_machine();
  return chosen;
}

}  // namespace

int farthest_along(const ScanList& list, const Vec3& d) {
  return scans().vectors(list, d);
}
std::uint64_t planes_behind(const ScanPlanes& planes, std::size_t first, const Vec3& p,
                            const Vec3& q, double distance) {
  return scans().planes(planes, first, p, q, distance);
}
std::uint64_t vectors_between(const double* x, const double* y, const double* z, std::size_t count,
                              const Vec3& p, const Vec3& q) {
  return scans().between(x, y, z, count, p, q);
}

}  // namespace vp::collide
