// Random shapes, and the exact separation of a pair by brute force: support functions written here
// and a search over directions.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "collide/distance.h"
#include "collide/geometry.h"
#include "random.h"

namespace vp::test {

using collide::Geometry;
using collide::Kind;

inline constexpr Kind kBounded[] = {Kind::sphere,   Kind::capsule, Kind::box,
                                    Kind::cylinder, Kind::cone,    Kind::hull};

// A shape with its geometry. The geometry points into the shape.
struct Solid {
  Shape shape;
  Geometry geometry;
  explicit Solid(Shape s) : shape(std::move(s)), geometry(collide::make_geometry(shape)) {}
};

inline collide::ClosestPoints closest(const Solid& a, const SE3& Ta, const Solid& b,
                                      const SE3& Tb) {
  collide::PairCache cache;
  return collide::closest_points(a.geometry, Ta, b.geometry, Tb, cache);
}

inline ConvexHull hull_of(std::span<const Vec3> points, const HullOptions& options = {}) {
  auto made = ConvexHull::of(points, options);
  if (!made) ADD_FAILURE() << made.error().message;
  return made.value();
}

inline std::vector<Vec3> box_corners(const Vec3& half) {
  std::vector<Vec3> corners;
  for (int i = 0; i < 8; ++i) {
    corners.push_back(
        {i & 4 ? half.x : -half.x, i & 2 ? half.y : -half.y, i & 1 ? half.z : -half.z});
  }
  return corners;
}

inline Solid random_solid(Random& random, Kind kind) {
  const double radius = random.uniform(0.1, 0.6), half = random.uniform(0.1, 1.0);
  switch (kind) {
    case Kind::sphere:
      return Solid(Sphere{radius});
    case Kind::capsule:
      return Solid(Capsule{radius, half});
    case Kind::cylinder:
      return Solid(Cylinder{radius, half});
    case Kind::cone:
      return Solid(Cone{radius, half});
    case Kind::half_space:
      return Solid(HalfSpace{});
    case Kind::box:
    case Kind::triangle:
    case Kind::mesh:
    case Kind::height_field:
    case Kind::compound:
      break;
    case Kind::hull: {
      std::vector<Vec3> points(4 + random.word() % 21);
      const Vec3 size{random.uniform(0.2, 1), random.uniform(0.2, 1), random.uniform(0.2, 1)};
      for (Vec3& p : points) {
        const Vec3 q = random.in_cube(1.0);
        p = {size.x * q.x, size.y * q.y, size.z * q.z};
      }
      return Solid(hull_of(points));
    }
  }
  const double x = random.uniform(0.2, 1), y = random.uniform(0.2, 1), z = random.uniform(0.2, 1);
  return Solid(Box{{x, y, z}});
}

// The support point of a shape in the direction n, both in the shape's frame.
inline Vec3 local_support(const Geometry& g, const Vec3& n) {
  const double across = std::sqrt(n.x * n.x + n.y * n.y);
  const Vec3 rim = across > 0.0 ? (g.radius / across) * Vec3{n.x, n.y, 0} : Vec3{};
  const auto side = [](double x, double h) { return x > 0 ? h : -h; };
  switch (g.kind) {
    case Kind::sphere:
      return (g.radius / norm(n)) * n;
    case Kind::capsule:
      return Vec3{0, 0, side(n.z, g.half.z)} + (g.radius / norm(n)) * n;
    case Kind::cylinder:
      return rim + Vec3{0, 0, side(n.z, g.half.z)};
    case Kind::cone: {
      const Vec3 apex{0, 0, g.half.z}, base = rim - Vec3{0, 0, g.half.z};
      return dot(n, apex) > dot(n, base) ? apex : base;
    }
    case Kind::hull: {
      Vec3 best = g.hull->vertices[0];
      for (const Vec3& v : g.hull->vertices) best = dot(n, v) > dot(n, best) ? v : best;
      return best;
    }
    default:
      return {side(n.x, g.half.x), side(n.y, g.half.y), side(n.z, g.half.z)};
  }
}
inline Vec3 support(const Geometry& g, const SE3& T, const Vec3& n) {
  return T * local_support(g, T.unrotate(n));
}

// Separation of the shapes' projections on n, with n from a to b.
inline double separation_along(const Geometry& a, const SE3& Ta, const Geometry& b, const SE3& Tb,
                               const Vec3& n) {
  return dot(n, support(b, Tb, -n) - support(a, Ta, n));
}

// The separation of two convex shapes is the maximum of separation_along over all directions. Hill
// climbing from many starts finds it, by a route independent of the distance and penetration
// algorithms.
inline double sampled_separation(Random& random, const Geometry& a, const SE3& Ta,
                                 const Geometry& b, const SE3& Tb) {
  double best = -1e30;
  for (int start = 0; start < 24; ++start) {
    Vec3 n = random.direction();
    double gap = separation_along(a, Ta, b, Tb, n);
    // A successful step doubles the step size, so that the search follows long ridges.
    for (double size = 0.5; size > 1e-7;) {
      Vec3 m = n + size * random.in_cube(1.0);
      m = (1.0 / norm(m)) * m;
      const double g = separation_along(a, Ta, b, Tb, m);
      size *= g > gap ? 2.0 : 0.93;
      if (g > gap) gap = g, n = m;
    }
    best = std::max(best, gap);
  }
  return best;
}

}  // namespace vp::test
