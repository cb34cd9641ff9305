// Distance of two convex cores by the algorithm of Gilbert, Johnson and Keerthi.
#pragma once

#include "collide/support.h"

namespace vp::collide {

// If a search ends while its bounds of the distance or depth differ by more than this [fraction of
// the smaller shape's size], it sets CorePair::rough.
inline constexpr double kRough = 1e-3;

// Two cores in the frame of a.
struct CorePair {
  const Geometry& a;
  const Geometry& b;
  SE3 T_a_b;
  double extent;  // scale of rounding errors: the size of both cores and their distance
  double size;    // scale of tolerances: the size of the smaller shape
  mutable int hint_a = 0, hint_b = 0;
  // A search ended with bounds that differ significantly (kRough).
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

// T_a_b of two world poses. It subtracts the positions first, so that shapes far from the origin
// lose no precision.
inline SE3 relative_pose(const SE3& T_a, const SE3& T_b) {
  return {transposed_times(T_a.rotation(), T_b.rotation()),
          T_a.unrotate(T_b.position() - T_a.position())};
}

// A point of a, and its difference from a point of b.
struct CorePoint {
  Vec3 a, w;

  Vec3 b() const { return a - w; }
};
inline CorePoint support_of(const CorePair& pair, const Vec3& n) {
  const Vec3 a = pair.support_a(n);
  return {a, a - pair.support_b(-n)};
}
// The separation of the projections on the unit vector n, from a to b: a lower bound of the
// distance.
inline double separation_along(const CorePair& pair, const Vec3& n) {
  return -dot(n, support_of(pair, n).w);
}

struct Simplex {
  CorePoint p[4];
  double weight[4];  // barycentric, of the point closest to the origin
  int count = 0;
};

struct GjkResult {
  enum class State : unsigned char {
    separated,  // normal, distance and points are set
    beyond,     // distance exceeds limit; `distance` along normal is a lower bound
    overlaps,   // or so close that the direction is rounding noise
  };
  State state;
  double distance = 0.0;  // separated: of the cores; beyond: the separation along normal
  Vec3 normal;            // unit, from a to b
  Vec3 on_a, on_b;
  Simplex simplex;  // for overlaps: contains or touches the origin
};

// start: any unit direction, preferably from a to b. Stops if a separation exceeds limit. first:
// the support point along start.
GjkResult gjk(const CorePair& pair, const Vec3& start, const CorePoint& first, double limit);
inline GjkResult gjk(const CorePair& pair, const Vec3& start, double limit) {
  return gjk(pair, start, support_of(pair, start), limit);
}

}  // namespace vp::collide
