// Axis-aligned bounding boxes (AABBs).
#pragma once

#include <algorithm>
#include <cmath>

#include "collide/geometry.h"

namespace vp::collide {

// Represents infinity. It is finite so that sums and differences of bounds are not NaN.
inline constexpr double kFar = 1e30;

struct Bounds {
  Vec3 lower{kFar, kFar, kFar};
  Vec3 upper{-kFar, -kFar, -kFar};
};

inline bool overlap(const Bounds& a, const Bounds& b) {
  return a.lower.x <= b.upper.x && b.lower.x <= a.upper.x && a.lower.y <= b.upper.y &&
         b.lower.y <= a.upper.y && a.lower.z <= b.upper.z && b.lower.z <= a.upper.z;
}
inline bool empty(const Bounds& a) {
  return a.lower.x > a.upper.x;
}
inline bool holds(const Bounds& outer, const Bounds& inner) {
  return outer.lower.x <= inner.lower.x && outer.lower.y <= inner.lower.y &&
         outer.lower.z <= inner.lower.z && inner.upper.x <= outer.upper.x &&
         inner.upper.y <= outer.upper.y && inner.upper.z <= outer.upper.z;
}
inline Bounds merged(const Bounds& a, const Bounds& b) {
  return {{std::min(a.lower.x, b.lower.x), std::min(a.lower.y, b.lower.y),
           std::min(a.lower.z, b.lower.z)},
          {std::max(a.upper.x, b.upper.x), std::max(a.upper.y, b.upper.y),
           std::max(a.upper.z, b.upper.z)}};
}
inline Bounds grown(const Bounds& a, double by) {
  return {a.lower - Vec3{by, by, by}, a.upper + Vec3{by, by, by}};
}
inline Bounds moved(const Bounds& a, const Vec3& by) {
  return {by + a.lower, by + a.upper};
}
// R| h: the half extents, along the outer axes, of a box rotated by R.
inline Vec3 rotated_extents(const Mat3& R, const Vec3& h) {
  return {std::fabs(R.cx.x) * h.x + std::fabs(R.cy.x) * h.y + std::fabs(R.cz.x) * h.z,
          std::fabs(R.cx.y) * h.x + std::fabs(R.cy.y) * h.y + std::fabs(R.cz.y) * h.z,
          std::fabs(R.cx.z) * h.x + std::fabs(R.cy.z) * h.y + std::fabs(R.cz.z) * h.z};
}

Bounds bounds_of(const Geometry& geometry, const SE3& T);
// Half of the smallest extent of the bounds in the shape's frame: of a compound, of its smallest
// part. 0 for surfaces.
double min_half_extent(const Geometry& geometry);
// The bounds in the outer frame of bounds given in an inner frame.
Bounds transformed(const SE3& T, const Bounds& inner);

}  // namespace vp::collide
