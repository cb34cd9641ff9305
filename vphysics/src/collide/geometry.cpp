#include "collide/geometry.h"

#include <algorithm>
#include <cmath>

#include "collide/compound_data.h"
#include "collide/surface.h"
#include "collide/triangle_parts.h"

namespace vp::collide {
namespace {

// Below this distance [m] to a feature the direction is rounding noise; a face normal is used.
constexpr double kDirectionNoise = 1e-12;

SignedDistance distance_to_point(const Vec3& d, double radius) {
  const double n = norm(d);
  if (n < kDirectionNoise) return {n - radius, {0, 0, 1}};
  return {n - radius, (1.0 / n) * d};
}

SignedDistance distance_to_capsule(double radius, double half, const Vec3& p) {
  const Vec3 d{p.x, p.y, p.z - std::clamp(p.z, -half, half)};
  if (d.z == 0.0 && half > 0.0 && norm(d) < kDirectionNoise) return {-radius, {1, 0, 0}};
  return distance_to_point(d, radius);
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

// Cylindrical coordinates: the distance rho from the axis and the height z.
struct Meridian {
  double rho, z;
  Vec3 outward;  // unit, from the axis towards the point
};
Meridian meridian(const Vec3& p) {
  const double rho = std::sqrt(p.x * p.x + p.y * p.y);
  if (rho < kDirectionNoise) return {rho, p.z, {1, 0, 0}};
  return {rho, p.z, {p.x / rho, p.y / rho, 0.0}};
}

SignedDistance distance_to_cylinder(double radius, double half, const Vec3& p) {
  const Meridian m = meridian(p);
  const Vec3 up{0, 0, p.z < 0.0 ? -1.0 : 1.0};
  const double side = m.rho - radius, cap = std::fabs(p.z) - half;
  if (side > 0.0 && cap > 0.0) {
    const double d = std::sqrt(side * side + cap * cap);
    if (d > kDirectionNoise) return {d, (side / d) * m.outward + (cap / d) * up};
  }
  return side > cap ? SignedDistance{side, m.outward} : SignedDistance{cap, up};
}

SignedDistance distance_to_cone(double radius, double half, const Vec3& p) {
  const Meridian m = meridian(p);
  // The side's line in the meridian plane, from the rim (radius, -half) to the apex (0, half).
  const double length = std::sqrt(radius * radius + 4.0 * half * half);
  const double n_rho = 2.0 * half / length, n_z = radius / length;
  const double side = n_rho * (m.rho - radius) + n_z * (m.z + half);
  const double base = -half - m.z;
  const Vec3 side_normal = n_rho * m.outward + Vec3{0, 0, n_z};
  double rho = 0.0, z = 0.0;  // the closest point, if it is on the rim or the apex
  if (side > 0.0) {
    const double along = n_rho * (m.z + half) - n_z * (m.rho - radius);  // from the rim
    if (along >= 0.0 && along <= length) return {side, side_normal};
    rho = along < 0.0 ? radius : 0.0;
    z = along < 0.0 ? -half : half;
  } else if (base > 0.0 && m.rho > radius) {
    rho = radius;
    z = -half;
  } else {
    return side > base ? SignedDistance{side, side_normal} : SignedDistance{base, {0, 0, -1}};
  }
  const double d_rho = m.rho - rho, d_z = m.z - z;
  const double d = std::sqrt(d_rho * d_rho + d_z * d_z);
  if (d < kDirectionNoise) return {d, side_normal};
  return {d, (d_rho / d) * m.outward + Vec3{0, 0, d_z / d}};
}

// The closest point of the segment from a to b.
Vec3 nearest_on_segment(const Vec3& a, const Vec3& b, const Vec3& p) {
  const Vec3 ab = b - a;
  return a + std::clamp(dot(p - a, ab) / dot(ab, ab), 0.0, 1.0) * ab;
}

// Inside: the least deep face. Outside: the face above which the point is, or else the closest edge
// of the faces that see the point.
SignedDistance distance_to_hull(const HullData& hull, const Vec3& p) {
  const ConvexHull::Face* highest = nullptr;
  double height = 0.0, nearest = 0.0;
  Vec3 on_edge;
  bool found = false;
  for (const ConvexHull::Face& face : hull.faces) {
    const double h = dot(face.normal, p) - face.offset;
    if (!highest || h > height) {
      height = h;
      highest = &face;
    }
    if (h <= 0.0) continue;
    bool over = true;
    const std::size_t n = face.vertices.size();
    for (std::size_t i = 0; i < n; ++i) {
      const Vec3 &a = hull.vertices[face.vertices[i]],
                 &b = hull.vertices[face.vertices[(i + 1) % n]];
      if (dot(cross(face.normal, b - a), p - a) >= 0.0) continue;
      over = false;
      const Vec3 q = nearest_on_segment(a, b, p);
      const double d2 = dot(p - q, p - q);
      if (found && d2 >= nearest) continue;
      found = true;
      nearest = d2;
      on_edge = q;
    }
    if (over) return {h, face.normal};
  }
  if (height <= 0.0 || !found) return {height, highest->normal};
  const double d = std::sqrt(nearest);
  if (d < kDirectionNoise) return {d, highest->normal};
  return {d, (1.0 / d) * (p - on_edge)};
}

// A triangle is a sheet: the distance is never negative.
SignedDistance distance_to_triangle(const Vec3* corners, const Vec3& p) {
  const Vec3 offset = p - nearest_on_triangle(corners, p).point;
  const double d = norm(offset);
  if (d > kDirectionNoise) return {d, (1.0 / d) * offset};
  const Vec3 n = cross(corners[1] - corners[0], corners[2] - corners[0]);
  return {d, (1.0 / norm(n)) * n};
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
  } else if (const auto* cylinder = std::get_if<Cylinder>(&shape)) {
    g.kind = Kind::cylinder;
    g.radius = cylinder->radius;
    g.half = {0, 0, cylinder->half_length};
  } else if (const auto* cone = std::get_if<Cone>(&shape)) {
    g.kind = Kind::cone;
    g.radius = cone->radius;
    g.half = {0, 0, cone->half_height};
  } else if (const auto* hull = std::get_if<ConvexHull>(&shape)) {
    g.kind = Kind::hull;
    g.hull = hull->data().get();
  } else if (const auto* mesh = std::get_if<TriangleMesh>(&shape)) {
    g.kind = Kind::mesh;
    g.mesh = mesh->data().get();
    g.half = mesh->scale();
  } else if (const auto* field = std::get_if<HeightField>(&shape)) {
    g.kind = Kind::height_field;
    g.field = field->data().get();
    g.half = field->scale();
  } else if (const auto* compound = std::get_if<Compound>(&shape)) {
    g.kind = Kind::compound;
    g.compound = compound->data().get();
  } else {
    g.kind = Kind::half_space;
  }
  return g;
}

Geometry triangle_geometry(const Vec3 corners[3]) {
  Geometry g;
  g.kind = Kind::triangle;
  g.corners = corners;
  return g;
}

Surface surface_of(const Geometry& g) {
  if (g.kind == Kind::mesh) return {*g.mesh, g.half};
  return {*g.field, g.half};
}

SignedDistance signed_distance(const Geometry& g, const Vec3& p) {
  switch (g.kind) {
    case Kind::sphere:
      return distance_to_point(p, g.radius);
    case Kind::capsule:
      return distance_to_capsule(g.radius, g.half.z, p);
    case Kind::box:
      return distance_to_box(g.half, p);
    case Kind::cylinder:
      return distance_to_cylinder(g.radius, g.half.z, p);
    case Kind::cone:
      return distance_to_cone(g.radius, g.half.z, p);
    case Kind::hull:
      return distance_to_hull(*g.hull, p);
    case Kind::triangle:
      return distance_to_triangle(g.corners, p);
    case Kind::mesh:
    case Kind::height_field:
    case Kind::compound:
    case Kind::half_space:
      break;
  }
  return {p.z, {0, 0, 1}};
}

}  // namespace vp::collide
