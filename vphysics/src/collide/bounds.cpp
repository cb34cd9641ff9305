#include "collide/bounds.h"

#include "collide/compound_data.h"
#include "collide/surface.h"

namespace vp::collide {
namespace {

// A half-space is unbounded. If its normal is along an axis, its surface is a tight bound.
Bounds half_space_bounds(const SE3& T) {
  const Vec3 n = T.rotation().cz;
  Bounds b{{-kFar, -kFar, -kFar}, {kFar, kFar, kFar}};
  for (int i = 0; i < 3; ++i) {
    if (n[i] == 1.0) b.upper[i] = T.position()[i];
    if (n[i] == -1.0) b.lower[i] = T.position()[i];
  }
  return b;
}

// The extents along the outer axes of a disc of radius 1 perpendicular to the axis.
Vec3 disc_extents(const Vec3& axis) {
  const double xx = axis.x * axis.x, yy = axis.y * axis.y, zz = axis.z * axis.z;
  return {std::sqrt(yy + zz), std::sqrt(zz + xx), std::sqrt(xx + yy)};
}

Bounds cylinder_bounds(const Geometry& g, const SE3& T) {
  const Vec3 e = rotated_extents(T.rotation(), g.half) + g.radius * disc_extents(T.rotation().cz);
  return {T.position() - e, T.position() + e};
}

Bounds cone_bounds(const Geometry& g, const SE3& T) {
  const Vec3 rise = g.half.z * T.rotation().cz, e = g.radius * disc_extents(T.rotation().cz);
  const Vec3 base = T.position() - rise, apex = T.position() + rise;
  return merged({base - e, base + e}, {apex, apex});
}

Bounds hull_bounds(const HullData& hull, const SE3& T) {
  Bounds b;
  for (const Vec3& v : hull.vertices) {
    const Vec3 p = T.rotate(v);
    b = merged(b, {p, p});
  }
  return {b.lower + T.position(), b.upper + T.position()};
}

}  // namespace

Bounds bounds_of(const Geometry& g, const SE3& T) {
  switch (g.kind) {
    case Kind::triangle: {
      Bounds b;
      for (int i = 0; i < 3; ++i) b = merged(b, {T * g.corners[i], T * g.corners[i]});
      return b;
    }
    case Kind::mesh:
    case Kind::height_field:
      return transformed(T, surface_of(g).bounds());
    case Kind::compound:
      return transformed(T, {g.compound->lower, g.compound->upper});
    case Kind::half_space:
      return half_space_bounds(T);
    case Kind::cylinder:
      return cylinder_bounds(g, T);
    case Kind::cone:
      return cone_bounds(g, T);
    case Kind::hull:
      return hull_bounds(*g.hull, T);
    case Kind::sphere:
    case Kind::capsule:
    case Kind::box:
      break;
  }
  const Vec3 e = rotated_extents(T.rotation(), g.half) + Vec3{g.radius, g.radius, g.radius};
  return {T.position() - e, T.position() + e};
}

double min_half_extent(const Geometry& g) {
  if (is_surface(g)) return 0.0;
  if (g.kind == Kind::compound) {
    double smallest = kFar;
    for (const Geometry& part : g.compound->geometries)
      smallest = std::min(smallest, min_half_extent(part));
    return smallest;
  }
  const Bounds own = bounds_of(g, SE3{});
  const Vec3 extents = own.upper - own.lower;
  return 0.5 * std::min({extents.x, extents.y, extents.z});
}

Bounds transformed(const SE3& T, const Bounds& inner) {
  if (empty(inner)) return inner;
  const Vec3 centre = T * (0.5 * (inner.lower + inner.upper));
  const Vec3 e = rotated_extents(T.rotation(), 0.5 * (inner.upper - inner.lower));
  return {centre - e, centre + e};
}

}  // namespace vp::collide
