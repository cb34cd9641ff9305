// Support mapping: the farthest point of a shape in a direction.
//
// A shape is a core swept by a sphere. A sphere's core is its centre, a capsule's its axis; every
// other shape is its own core, with radius zero.
#pragma once

#include <algorithm>
#include <cmath>

#include "collide/geometry.h"

namespace vp::collide {

inline double core_radius(const Geometry& g) {
  return g.kind == Kind::sphere || g.kind == Kind::capsule ? g.radius : 0.0;
}

// A point of the core; no point of the core is farther from it than core_extent.
inline Vec3 core_centre(const Geometry& g) {
  if (g.kind == Kind::hull) return g.hull->centre;
  if (g.kind == Kind::triangle) {
    return (1.0 / 3.0) * (g.corners[0] + g.corners[1] + g.corners[2]);
  }
  return {};
}
inline double core_extent(const Geometry& g) {
  switch (g.kind) {
    case Kind::sphere:
      return 0.0;
    case Kind::hull:
      return g.hull->radius;
    case Kind::cylinder:
    case Kind::cone:
      return std::sqrt(g.radius * g.radius + g.half.z * g.half.z);
    case Kind::triangle: {
      const Vec3 m = core_centre(g);
      return std::max({norm(g.corners[0] - m), norm(g.corners[1] - m), norm(g.corners[2] - m)});
    }
    case Kind::capsule:
    case Kind::box:
    case Kind::half_space:
    case Kind::mesh:
    case Kind::height_field:
    case Kind::compound:
      break;
  }
  return norm(g.half);
}

// Scans all vertices if they are few; otherwise climbs from neighbour to neighbour.
int support_vertex(const HullData& hull, const Vec3& d, int hint);

inline Vec3 rim_direction(const Vec3& d) {
  const double radial = std::sqrt(d.x * d.x + d.y * d.y);
  if (!(radial > 1e-150)) return {1, 0, 0};
  return {d.x / radial, d.y / radial, 0};
}

// In the shape's frame; d need not be of unit length. hint: a hull vertex to start from; receives
// the one found.
inline Vec3 core_support(const Geometry& g, const Vec3& d, int& hint) {
  switch (g.kind) {
    case Kind::sphere:
    case Kind::half_space:
    case Kind::mesh:
    case Kind::height_field:
    case Kind::compound:
      return {};
    case Kind::triangle: {
      const double along[3] = {dot(d, g.corners[0]), dot(d, g.corners[1]), dot(d, g.corners[2])};
      const int best = along[1] > along[0] ? 1 : 0;
      return g.corners[along[2] > along[best] ? 2 : best];
    }
    case Kind::capsule:
      return {0, 0, std::copysign(g.half.z, d.z)};
    case Kind::box:
      return {std::copysign(g.half.x, d.x), std::copysign(g.half.y, d.y),
              std::copysign(g.half.z, d.z)};
    case Kind::cylinder:
      return g.radius * rim_direction(d) + Vec3{0, 0, std::copysign(g.half.z, d.z)};
    case Kind::cone: {
      // The apex is farther than the base's rim if 2 h d_z > r |(d_x, d_y)|.
      const double radial = std::sqrt(d.x * d.x + d.y * d.y);
      if (2.0 * g.half.z * d.z > g.radius * radial) return {0, 0, g.half.z};
      return g.radius * rim_direction(d) - Vec3{0, 0, g.half.z};
    }
    case Kind::hull:
      break;
  }
  hint = support_vertex(*g.hull, d, hint);
  return g.hull->vertices[static_cast<std::size_t>(hint)];
}

}  // namespace vp::collide
