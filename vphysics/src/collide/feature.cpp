// A disc is a polygon of 16 corners that rotate with the shape, plus the exact deepest point of its
// rim. So a shape that rests on the disc keeps the feature names of its points, and a shape that
// tips or rolls on its rim rolls on a circle.
#include "collide/feature.h"

#include "collide/polytope.h"

namespace vp::collide {
namespace {

constexpr int kRim = 16;
// cos and sin of multiples of pi / 8.
constexpr double kC1 = 0.9238795325112867, kS1 = 0.3826834323650898, kR = 0.7071067811865476;
constexpr double kRimCos[kRim] = {1,  kC1,  kR,  kS1,  0, -kS1, -kR, -kC1,
                                  -1, -kC1, -kR, -kS1, 0, kS1,  kR,  kC1};
constexpr double kRimSin[kRim] = {0, kS1,  kR,  kC1,  1,  kC1,  kR,  kS1,
                                  0, -kS1, -kR, -kC1, -1, -kC1, -kR, -kS1};
// Name ranges: corners and edges of the upper rim, of the lower one, and of the side.
constexpr int kUpper = 0, kLower = 32, kSide = 64;

void add(Feature& f, const Vec3& p, int name, int edge) {
  f.corners[f.count++] = {p.x, p.y, p.z, static_cast<std::uint16_t>(name),
                          static_cast<std::uint16_t>(edge)};
}
void add(Feature& f, const SE3& T, const Vec3& p, int name, int edge) {
  add(f, T * p, name, edge);
}

void set_normal(Feature& f, const SE3& T, const Vec3& n) {
  const Vec3 m = T.rotate(n);
  f.normal_x = m.x;
  f.normal_y = m.y;
  f.normal_z = m.z;
}

// The disc at height z, facing up or down.
void disc_feature(double radius, double z, const SE3& T, const Vec3& d, Feature& f) {
  const bool up = z > 0.0;
  const int base = up ? kUpper : kLower;
  f.count = 0;
  set_normal(f, T, {0, 0, up ? 1.0 : -1.0});
  const double radial = std::sqrt(d.x * d.x + d.y * d.y);
  const double cos = radial > 0.0 ? d.x / radial : 1.0, sin = radial > 0.0 ? d.y / radial : 0.0;
  for (int k = 0; k < kRim; ++k) {
    const int i = up ? k : kRim - 1 - k, next = up ? (i + 1) % kRim : (i + kRim - 1) % kRim;
    add(f, T, {radius * kRimCos[i], radius * kRimSin[i], z}, base + i, base + (up ? i : next));
    // The deepest point is between this corner and the next, clear of both. If the disc is nearly
    // upright (sine of the tilt), the point would be deeper by less than a millionth of the radius,
    // and its position arbitrary.
    constexpr double kClear = 1e-4, kUpright = 3e-5;
    const double after = kRimCos[i] * sin - kRimSin[i] * cos;
    const double before = cos * kRimSin[next] - sin * kRimCos[next];
    const bool between =
        up ? after > kClear && before > kClear : after < -kClear && before < -kClear;
    if (radial > kUpright * norm(d) && between) {
      add(f, T, {radius * cos, radius * sin, z}, base + kRim, base + kRim);
    }
  }
}

void segment_feature(const SE3& T, const Vec3& p, const Vec3& q, int name, Feature& f) {
  f.count = 0;
  add(f, T, p, name, name);
  add(f, T, q, name + 1, name);
}

void cylinder_feature(const Geometry& g, const SE3& T, const Vec3& d, Feature& f) {
  const double radial = std::sqrt(d.x * d.x + d.y * d.y);
  if (std::fabs(d.z) > radial) {
    disc_feature(g.radius, std::copysign(g.half.z, d.z), T, d, f);
  } else {
    const Vec3 rim = g.radius * rim_direction(d);
    segment_feature(T, rim - g.half, rim + g.half, kSide, f);
  }
}

void cone_feature(const Geometry& g, const SE3& T, const Vec3& d, Feature& f) {
  const double radial = std::sqrt(d.x * d.x + d.y * d.y), h = 2.0 * g.half.z, r = g.radius;
  // Alignment of d with the base's normal and with the side's.
  const double base = -d.z, side = (h * radial + r * d.z) / std::sqrt(h * h + r * r);
  if (base > side) {
    disc_feature(r, -g.half.z, T, d, f);
  } else {
    segment_feature(T, r * rim_direction(d) - g.half, g.half, kSide, f);
  }
}

// Seen from behind, the order of its corners is reversed.
void triangle_feature(const Vec3* p, const SE3& T, const Vec3& d, Feature& f) {
  const Vec3 n = cross(p[1] - p[0], p[2] - p[0]);
  const bool front = dot(n, d) >= 0.0;
  f.count = 0;
  set_normal(f, T, ((front ? 1.0 : -1.0) / norm(n)) * n);
  add(f, T, p[0], 0, front ? 0 : 2);
  add(f, T, p[front ? 1 : 2], front ? 1 : 2, 1);
  add(f, T, p[front ? 2 : 1], front ? 2 : 1, front ? 2 : 0);
}

int aligned_box_face(const Vec3& d) {
  int axis = 0;
  for (int i = 1; i < 3; ++i) {
    if (std::fabs(d[i]) > std::fabs(d[axis])) axis = i;
  }
  return kBoxFace[axis][d[axis] > 0.0 ? 1 : 0];
}

// Among the faces around the farthest vertex, the one most aligned with d.
int aligned_hull_face(const HullData& hull, const Vec3& d) {
  const auto v = static_cast<std::size_t>(support_vertex(hull, d, 0));
  int best = hull.faces_around[hull.first_around[v]];
  double largest = -2.0;
  for (std::size_t k = hull.first_around[v]; k < hull.first_around[v + 1]; ++k) {
    const double along = dot(hull.faces[hull.faces_around[k]].normal, d);
    if (along > largest) {
      largest = along;
      best = hull.faces_around[k];
    }
  }
  return best;
}

// Corners of a box differ along one axis: that of the bit in which their numbers differ.
Vec3 between_corners(const Vec3& half, const Mat3& R, int from, int to) {
  const int bit = from ^ to;
  const int axis = bit == 4 ? 0 : bit == 2 ? 1 : 2;
  const double length = 2.0 * half[axis];
  return ((to & bit) != 0 ? length : -length) * (axis == 0 ? R.cx : axis == 1 ? R.cy : R.cz);
}

void box_face_feature(const Vec3& half, const SE3& T, std::size_t face, Feature& f) {
  const auto& corners = kBoxCorners[face];
  const auto& edges = kBoxCornerEdges[face];
  f.count = 0;
  Vec3 n;
  n[kBoxFaceAxis[face]] = kBoxFaceSide[face];
  set_normal(f, T, n);
  const Vec3 first = T * box_corner(half, corners[0]);
  const Vec3 second = between_corners(half, T.rotation(), corners[0], corners[1]);
  const Vec3 last = between_corners(half, T.rotation(), corners[0], corners[3]);
  add(f, first, corners[0], edges[0]);
  add(f, first + second, corners[1], edges[1]);
  add(f, first + second + last, corners[2], edges[2]);
  add(f, first + last, corners[3], edges[3]);
}

}  // namespace

void face_feature(const Geometry& g, const SE3& T, int face, Feature& f) {
  const auto k = static_cast<std::size_t>(face);
  if (g.kind == Kind::box) return box_face_feature(g.half, T, k, f);
  f.count = 0;
  const HullData& hull = *g.hull;
  set_normal(f, T, hull.faces[k].normal);
  const std::size_t first = hull.first_corner[k], n = hull.faces[k].vertices.size();
  const std::size_t stride = (n + kMaxCorners - 1) / kMaxCorners;
  for (std::size_t i = 0; i < n; i += stride) {
    const std::uint16_t v = hull.corners[first + i];
    add(f, T, hull.vertices[v], v, hull.corner_edges[first + i]);
  }
}

void find_feature(const Geometry& g, const SE3& T, const Vec3& d, Feature& f) {
  switch (g.kind) {
    case Kind::sphere:
    case Kind::half_space:
    case Kind::mesh:
    case Kind::height_field:
    case Kind::compound:
      f.count = 0;
      return add(f, T, {}, 0, 0);
    case Kind::capsule:
      if (g.half.z > 0.0) return segment_feature(T, -g.half, g.half, 0, f);
      f.count = 0;
      return add(f, T, {}, 0, 0);
    case Kind::cylinder:
      return cylinder_feature(g, T, d, f);
    case Kind::cone:
      return cone_feature(g, T, d, f);
    case Kind::box:
      return face_feature(g, T, aligned_box_face(d), f);
    case Kind::hull:
      return face_feature(g, T, aligned_hull_face(*g.hull, d), f);
    case Kind::triangle:
      return triangle_feature(g.corners, T, d, f);
  }
}

}  // namespace vp::collide
