// Scans over all vertices, faces or edges of a hull, four or eight at a time. The results do not
// depend on the instruction set.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "vphysics/convex_hull.h"

namespace vp::collide {

inline constexpr std::size_t kScanLanes = 8;
inline constexpr std::size_t kScanBits = 64;  // planes or vectors of a scan that returns a bit each

// Vectors in structure-of-arrays layout, padded to a multiple of kScanLanes before they are
// scanned.
struct ScanList {
  std::vector<double> x, y, z;

  void add(const Vec3& v) {
    x.push_back(v.x);
    y.push_back(v.y);
    z.push_back(v.z);
  }
  bool is_whole() const { return x.size() % kScanLanes == 0; }
  bool empty() const { return x.empty(); }
};

// Planes normal . p = offset, as many of each.
struct ScanPlanes {
  ScanList normal;
  std::vector<double> offset;
};

// The first of the vectors that are farthest along d; 0 if d is not a number. Precondition: there
// are some.
int farthest_along(const ScanList& list, const Vec3& d);

// Of the kScanBits planes from index `first` on: a bit for each that has both p and q in front of
// it, farther than `distance`. Precondition: first is a multiple of kScanBits.
std::uint64_t planes_behind(const ScanPlanes& planes, std::size_t first, const Vec3& p,
                            const Vec3& q, double distance);

// Of at most kScanBits vectors: a bit for each that p and q have on different sides, (p . v) (q .
// v) < 0. count: of readable values x, y and z each, a multiple of kScanLanes.
std::uint64_t vectors_between(const double* x, const double* y, const double* z, std::size_t count,
                              const Vec3& p, const Vec3& q);

}  // namespace vp::collide
