// Distance of two convex cores: Gilbert, Johnson and Keerthi's algorithm.
#pragma once

#include "collide/support.h"

namespace vp::collide {

// Bounds of a distance or a depth that are farther apart [share of the smaller shape's size] when a
// search has to end are told (CorePair::rough).
inline constexpr double kRough = 1e-3;

// Two cores in the frame of a.
struct CorePair {
  const Geometry& a;
  const Geometry& b;
  SE3 T_a_b;
  double extent;  // by which rounding is measured: the size of both cores and their distance
  double size;    // by which shapes are: that of the smaller one
  mutable int hint_a = 0, hint_b = 0;
  // A search ended before its bounds had met, so far apart that it matters (kRough).
  mutable bool rough = false;

  CorePair(const Geometry& shape_a, const Geometry& shape_b, const SE3& pose)
      : a(shape_a), b(shape_b), T_a_b(pose) {
    const double extent_a = core_extent(a), extent_b = core_extent(b);
    extent = extent_a + extent_b + norm(pose * core_centre(b) - core_centre(a));
    size = std::min(extent_a + core_radius(a), extent_b + core_radius(b));
  }

  Vec3 support_a(const Vec3& d) const { return core_support(a, d, hint_a); }
  Vec3 support_b(const Vec3& d) const { return T_a_b * core_support(b, T_a_b.unrotate(d), hint_b); }
};

// T_a_b of two poses in the world: their difference is taken first, so that shapes far from the
// origin lose nothing.
inline SE3 relative_pose(const SE3& T_a, const SE3& T_b) {
  return {transposed_times(T_a.rotation(), T_b.rotation()),
          T_a.unrotate(T_b.position() - T_a.position())};
}

// A point of a and its difference from one of b.
struct CorePoint {
  Vec3 a, w;

  Vec3 b() const { return a - w; }
};
inline CorePoint support_of(const CorePair& pair, const Vec3& n) {
  const Vec3 a = pair.support_a(n);
  return {a, a - pair.support_b(-n)};
}
// The gap between the projections on the unit vector n, from a to b: never more than the distance.
inline double separation_along(const CorePair& pair, const Vec3& n) {
  return -dot(n, support_of(pair, n).w);
}

struct Simplex {
  CorePoint p[4];
  double weight[4];  // of the point nearest to the origin
  int count = 0;
};

struct GjkResult {
  enum class State : unsigned char {
    separated,  // normal, distance and points are set
    beyond,     // farther apart than limit; normal separates them by at least separated
    overlaps,   // or so near that the direction is rounding noise
  };
  State state;
  double distance = 0.0;  // apart: of the cores; beyond: the gap along normal
  Vec3 normal;            // unit, from a to b
  Vec3 on_a, on_b;
  Simplex simplex;  // overlaps: it holds the origin, or touches it
};

// start: any direction, unit, from a to b as far as is known. Gives up at a gap of more than limit.
GjkResult gjk(const CorePair& pair, const Vec3& start, double limit);

}  // namespace vp::collide
