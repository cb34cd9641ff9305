#include "collide/hull_scan.h"

#include <algorithm>
#include <cstdint>
#include <cstring>

#include "collide/bounds.h"

namespace vp::collide {
namespace {

// Eight numbers in parallel, or as many at a time as the machine has registers for.
using Eight [[gnu::vector_size(64)]] = double;
using EightWords [[gnu::vector_size(64)]] = std::int64_t;

[[gnu::always_inline]] inline void load(Eight& to, const double* from) {
  std::memcpy(&to, from, sizeof to);
}

// The bits of all lanes into each.
[[gnu::always_inline]] inline void merge_lanes(EightWords& bits) {
  bits |= __builtin_shufflevector(bits, bits, 4, 5, 6, 7, 0, 1, 2, 3);
  bits |= __builtin_shufflevector(bits, bits, 2, 3, 0, 1, 6, 7, 4, 5);
  bits |= __builtin_shufflevector(bits, bits, 1, 0, 3, 2, 5, 4, 7, 6);
}

[[gnu::always_inline]] inline int scan_vectors(const ScanList& list, const Vec3& d) {
  Eight largest = Eight{} - kFar, found{}, at{0, 1, 2, 3, 4, 5, 6, 7};
  for (std::size_t i = 0; i < list.x.size(); i += kScanLanes) {
    Eight x, y, z;
    load(x, &list.x[i]);
    load(y, &list.y[i]);
    load(z, &list.z[i]);
    const Eight along = d.x * x + d.y * y + d.z * z;
    const auto farther = along > largest;
    largest = farther ? along : largest;
    found = farther ? at : found;
    at += static_cast<double>(kScanLanes);
  }
  // The largest of all lanes into all lanes; then, of the lanes that have it, the first index.
  Eight most = largest, other;
  other = __builtin_shufflevector(most, most, 4, 5, 6, 7, 0, 1, 2, 3);
  most = other > most ? other : most;
  other = __builtin_shufflevector(most, most, 2, 3, 0, 1, 6, 7, 4, 5);
  most = other > most ? other : most;
  other = __builtin_shufflevector(most, most, 1, 0, 3, 2, 5, 4, 7, 6);
  most = other > most ? other : most;
  Eight first = largest == most ? found : Eight{} + kFar;
  other = __builtin_shufflevector(first, first, 4, 5, 6, 7, 0, 1, 2, 3);
  first = other < first ? other : first;
  other = __builtin_shufflevector(first, first, 2, 3, 0, 1, 6, 7, 4, 5);
  first = other < first ? other : first;
  other = __builtin_shufflevector(first, first, 1, 0, 3, 2, 5, 4, 7, 6);
  first = other < first ? other : first;
  return static_cast<int>(first[0]);
}

[[gnu::always_inline]] inline std::uint64_t scan_planes(const ScanPlanes& planes, std::size_t first,
                                                        const Vec3& p, const Vec3& q,
                                                        double distance) {
  EightWords found{}, bit{1, 2, 4, 8, 16, 32, 64, 128};
  const std::size_t end = std::min(planes.offset.size(), first + 64);
  for (std::size_t i = first; i < end; i += kScanLanes) {
    Eight x, y, z, offset;
    load(x, &planes.normal.x[i]);
    load(y, &planes.normal.y[i]);
    load(z, &planes.normal.z[i]);
    load(offset, &planes.offset[i]);
    const Eight of_p = (p.x * x + p.y * y + p.z * z) - offset;
    const Eight of_q = (q.x * x + q.y * y + q.z * z) - offset;
    found |= (of_p > distance) & (of_q > distance) & bit;
    bit <<= static_cast<int>(kScanLanes);
  }
  merge_lanes(found);
  return static_cast<std::uint64_t>(found[0]);
}

[[gnu::always_inline]] inline std::uint64_t scan_between(const double* x, const double* y,
                                                         const double* z, std::size_t count,
                                                         const Vec3& p, const Vec3& q) {
  EightWords found{}, bit{1, 2, 4, 8, 16, 32, 64, 128};
  for (std::size_t i = 0; i < count; i += kScanLanes) {
    Eight vx, vy, vz;
    load(vx, x + i);
    load(vy, y + i);
    load(vz, z + i);
    const Eight of_p = p.x * vx + p.y * vy + p.z * vz, of_q = q.x * vx + q.y * vy + q.z * vz;
    found |= (of_p * of_q < 0.0) & bit;
    bit <<= static_cast<int>(kScanLanes);
  }
  merge_lanes(found);
  return static_cast<std::uint64_t>(found[0]);
}

struct Scans {
  int (*vectors)(const ScanList&, const Vec3&);
  std::uint64_t (*planes)(const ScanPlanes&, std::size_t, const Vec3&, const Vec3&, double);
  std::uint64_t (*between)(const double*, const double*, const double*, std::size_t, const Vec3&,
                           const Vec3&);
};

// The three for one instruction set, to the same bits: nothing is fused.
#define VP_SCANS(NAME, ...)                                                                   \
  __VA_ARGS__ int vectors_##NAME(const ScanList& list, const Vec3& d) {                       \
    return scan_vectors(list, d);                                                             \
  }                                                                                           \
  __VA_ARGS__ std::uint64_t planes_##NAME(const ScanPlanes& planes, std::size_t first,        \
                                          const Vec3& p, const Vec3& q, double distance) {    \
    return scan_planes(planes, first, p, q, distance);                                        \
  }                                                                                           \
  __VA_ARGS__ std::uint64_t between_##NAME(const double* x, const double* y, const double* z, \
                                           std::size_t count, const Vec3& p, const Vec3& q) { \
    return scan_between(x, y, z, count, p, q);                                                \
  }                                                                                           \
  constexpr Scans k_##NAME = {vectors_##NAME, planes_##NAME, between_##NAME};

VP_SCANS(baseline)
#ifdef VP_INSTRUCTION_SETS
VP_SCANS(avx2, [[gnu::target("avx2")]])
VP_SCANS(avx512, [[gnu::target("avx512f,avx512vl,avx512dq,avx512bw,prefer-vector-width=512")]])
#endif
#undef VP_SCANS

Scans scans_of_this_machine() {
#ifdef VP_INSTRUCTION_SETS
  __builtin_cpu_init();
  const bool avx2 = __builtin_cpu_supports("avx2");
  if (avx2 && __builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512vl") &&
      __builtin_cpu_supports("avx512dq") && __builtin_cpu_supports("avx512bw")) {
    return k_avx512;
  }
  if (avx2) return k_avx2;
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
