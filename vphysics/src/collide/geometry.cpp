#include "collide/geometry.h"

#include <algorithm>
#include <cmath>

namespace vp::collide {
namespace {

// Closer to a feature than this [m], its direction is rounding noise; a face normal is taken.
constexpr double kDirectionNoise = 1e-12;

SignedDistance distance_to_point(const Vec3& d, double radius) {
  const double n = norm(d);
  if (n < kDirectionNoise) return {n - radius, {0, 0, 1}};
  return {n - radius, (1.0 / n) * d};
}

SignedDistance distance_to_box(const Vec3& half, const Vec3& p) {
  const Vec3 nearest{std::clamp(p.x, -half.x, half.x), std::clamp(p.y, -half.y, half.y),
                     std::clamp(p.z, -half.z, half.z)};
  const Vec3 d = p - nearest;
  const double outside = norm(d);
  if (outside > kDirectionNoise) return {outside, (1.0 / outside) * d};
  int axis = 0;
  double depth = std::fabs(p.x) - half.x;
  for (int i = 1; i < 3; ++i) {
    const double di = std::fabs(p[i]) - half[i];
    if (di > depth) {
      depth = di;
      axis = i;
    }
  }
  Vec3 n;
  n[axis] = p[axis] < 0.0 ? -1.0 : 1.0;
  return {depth, n};
}

}  // namespace

Geometry make_geometry(const Shape& shape) {
  Geometry g;
  if (const auto* sphere = std::get_if<Sphere>(&shape)) {
    g.kind = Kind::sphere;
    g.radius = sphere->radius;
  } else if (const auto* box = std::get_if<Box>(&shape)) {
    g.kind = Kind::box;
    g.half = box->half_extents;
  } else if (const auto* capsule = std::get_if<Capsule>(&shape)) {
    g.kind = Kind::capsule;
    g.radius = capsule->radius;
    g.half = {0, 0, capsule->half_length};
  } else {
    g.kind = Kind::half_space;
  }
  return g;
}

SignedDistance signed_distance(const Geometry& g, const Vec3& p) {
  switch (g.kind) {
    case Kind::sphere:
      return distance_to_point(p, g.radius);
    case Kind::capsule:
      return distance_to_point({p.x, p.y, p.z - std::clamp(p.z, -g.half.z, g.half.z)}, g.radius);
    case Kind::box:
      return distance_to_box(g.half, p);
    case Kind::half_space:
      break;
  }
  return {p.z, {0, 0, 1}};
}

}  // namespace vp::collide

namespace vp {

Inertia solid_inertia(const Shape& shape, double density) {
  if (const auto* sphere = std::get_if<Sphere>(&shape)) {
    const double r = sphere->radius;
    const double m = density * (4.0 / 3.0) * kPi * r * r * r;
    const double I = 0.4 * m * r * r;
    return {m, Vec3{I, I, I}};
  }
  if (const auto* box = std::get_if<Box>(&shape)) {
    const Vec3 h = box->half_extents;
    const double m = density * 8.0 * h.x * h.y * h.z;
    const double x = h.x * h.x, y = h.y * h.y, z = h.z * h.z;
    return {m, (m / 3.0) * Vec3{y + z, z + x, x + y}};
  }
  if (const auto* capsule = std::get_if<Capsule>(&shape)) {
    // A cylinder of length 2 l and two half spheres, whose centres of mass lie 3/8 r beyond its
    // ends.
    const double r = capsule->radius, l = capsule->half_length;
    const double cylinder = density * kPi * r * r * 2.0 * l;
    const double ball = density * (4.0 / 3.0) * kPi * r * r * r;
    const double axial = 0.5 * cylinder * r * r + 0.4 * ball * r * r;
    const double across =
        cylinder * (r * r / 4.0 + l * l / 3.0) + ball * (0.4 * r * r + l * l + 0.75 * l * r);
    return {cylinder + ball, Vec3{across, across, axial}};
  }
  return {};
}

}  // namespace vp
