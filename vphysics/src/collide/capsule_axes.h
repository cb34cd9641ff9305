// A capsule's axis as a segment; closest points of two segments.
#pragma once

#include <algorithm>
#include <cmath>

#include "vphysics/lie.h"

namespace vp::collide {

struct Axis {
  Vec3 centre, direction;  // unit
  double half;             // length

  Vec3 at(double s) const { return centre + s * direction; }
};

struct AxisPair {
  double s, t;
};
// The closest points of two segments: s on a, t on b.
inline AxisPair nearest_on_axes(const Axis& a, const Axis& b) {
  const Vec3 r = a.centre - b.centre;
  const double k = dot(a.direction, b.direction), ra = dot(a.direction, r),
               rb = dot(b.direction, r);
  const double parallel = 1.0 - k * k;
  double s = parallel > 1e-12 ? std::clamp((k * rb - ra) / parallel, -a.half, a.half) : 0.0;
  const double t = std::clamp(k * s + rb, -b.half, b.half);
  s = std::clamp(k * t - ra, -a.half, a.half);
  return {s, std::clamp(k * s + rb, -b.half, b.half)};
}

// The unit normal from a to b along d, which joins the closest points. If the axes intersect, it is
// perpendicular to both.
inline Vec3 normal_between(const Axis& a, const Axis& b, const Vec3& d) {
  const double distance = norm(d);
  if (distance > 1e-12) return (1.0 / distance) * d;
  const Vec3 perpendicular = cross(a.direction, b.direction);
  const double sine = norm(perpendicular);
  if (sine > 1e-9) return (1.0 / sine) * perpendicular;
  // Parallel axes: any direction perpendicular to them.
  const Vec3 e = std::fabs(a.direction.x) < 0.6 ? Vec3{1, 0, 0} : Vec3{0, 1, 0};
  const Vec3 n = cross(a.direction, e);
  return (1.0 / norm(n)) * n;
}

}  // namespace vp::collide
