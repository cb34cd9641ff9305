#include "collide/bounds.h"

namespace vp::collide {
namespace {

// A half-space is unbounded, but for a normal along an axis its surface is a tight face.
Bounds half_space_bounds(const SE3& T) {
  const Vec3 n = T.rotation().cz;
  Bounds b{{-kFar, -kFar, -kFar}, {kFar, kFar, kFar}};
  for (int i = 0; i < 3; ++i) {
    if (n[i] == 1.0) b.upper[i] = T.position()[i];
    if (n[i] == -1.0) b.lower[i] = T.position()[i];
  }
  return b;
}

}  // namespace

Bounds bounds_of(const Geometry& g, const SE3& T) {
  if (g.kind == Kind::half_space) return half_space_bounds(T);
  const Vec3 e = turned_extents(T.rotation(), g.half) + Vec3{g.radius, g.radius, g.radius};
  return {T.position() - e, T.position() + e};
}

Bounds transformed(const SE3& T, const Bounds& inner) {
  if (empty(inner)) return inner;
  const Vec3 centre = T * (0.5 * (inner.lower + inner.upper));
  const Vec3 e = turned_extents(T.rotation(), 0.5 * (inner.upper - inner.lower));
  return {centre - e, centre + e};
}

}  // namespace vp::collide
