// Box against box: separating axis theorem, then the incident face clipped to the reference face,
// or the nearest points of two edges. Source: Gottschalk, Lin, Manocha 1996 (OBBTree), section 5;
// Sutherland and Hodgman 1974 for the clipping.
#include <algorithm>
#include <array>
#include <cmath>
#include <span>

#include "collide/bounds.h"
#include "collide/manifold.h"

namespace vp::collide {
namespace {

// An edge pair wins over a face only if it separates clearly better: face manifolds have several
// points and are steadier. Share of the depth, and metres.
constexpr double kEdgeRelative = 0.95;
constexpr double kEdgeAbsolute = 1e-5;
constexpr double kParallel = 1e-8;  // squared sine below which two edges give no axis

Vec3 axis_of(const Mat3& R, int i) {
  return i == 0 ? R.cx : i == 1 ? R.cy : R.cz;
}

struct BestAxis {
  double separation = -kFar;
  Vec3 normal;  // from a to b
  int i = 0;    // axis of a; or of b, see face_of_b
  int j = -1;   // axis of b of an edge pair; -1: a face
  bool face_of_b = false;
};

double extent_along(const Mat3& R, const Vec3& half, const Vec3& n) {
  return std::fabs(dot(R.cx, n)) * half.x + std::fabs(dot(R.cy, n)) * half.y +
         std::fabs(dot(R.cz, n)) * half.z;
}

// False as soon as an axis separates by more than margin.
bool find_best_axis(const Vec3& ha, const Mat3& A, const Vec3& hb, const Mat3& B, const Vec3& d,
                    double margin, BestAxis& best) {
  for (int k = 0; k < 6; ++k) {
    const bool of_b = k >= 3;
    const Vec3 n = axis_of(of_b ? B : A, k % 3);
    const double along = dot(n, d);
    const double reach =
        of_b ? hb[k % 3] + extent_along(A, ha, n) : ha[k % 3] + extent_along(B, hb, n);
    const double separation = std::fabs(along) - reach;
    if (separation > margin) return false;
    if (separation > best.separation) best = {separation, along < 0.0 ? -n : n, k % 3, -1, of_b};
  }
  BestAxis edge;
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) {
      Vec3 n = cross(axis_of(A, i), axis_of(B, j));
      const double n2 = dot(n, n);
      if (n2 < kParallel) continue;
      n = (1.0 / std::sqrt(n2)) * n;
      const double along = dot(n, d);
      const double separation = std::fabs(along) - extent_along(A, ha, n) - extent_along(B, hb, n);
      if (separation > margin) return false;
      if (separation > edge.separation) edge = {separation, along < 0.0 ? -n : n, i, j, false};
    }
  }
  const double face = best.separation;
  const double needed = face < 0.0 ? kEdgeRelative * face + kEdgeAbsolute : face + kEdgeAbsolute;
  if (edge.separation > needed) best = edge;
  return true;
}

// Centre of the edge of a box, along its axis i, that lies farthest in the direction n.
Vec3 supporting_edge(const SE3& T, const Vec3& half, int i, const Vec3& n) {
  Vec3 p;
  for (int k = 0; k < 3; ++k) {
    if (k != i) p[k] = dot(axis_of(T.rotation(), k), n) > 0.0 ? half[k] : -half[k];
  }
  return T * p;
}

void edge_contact(const Vec3& ha, const SE3& Ta, const Vec3& hb, const SE3& Tb,
                  const BestAxis& best, Manifold& m) {
  const Vec3 da = axis_of(Ta.rotation(), best.i), db = axis_of(Tb.rotation(), best.j);
  const Vec3 pa = supporting_edge(Ta, ha, best.i, best.normal);
  const Vec3 pb = supporting_edge(Tb, hb, best.j, -best.normal);
  const double k = dot(da, db);
  const Vec3 r = pa - pb;
  const double s = (k * dot(db, r) - dot(da, r)) / (1.0 - k * k);
  const double t = dot(db, r) + k * s;
  m.normal = best.normal;
  m.add(0.5 * (pa + s * da + pb + t * db), best.separation,
        static_cast<std::uint32_t>(256 + 3 * best.i + best.j));
}

struct ClipVertex {
  Vec3 p;
  std::uint32_t feature;
};
// A quadrilateral cut by four planes has at most eight corners.
struct Polygon {
  std::array<ClipVertex, 8> v;
  int count = 0;
  void add(const ClipVertex& c) {
    if (count < 8) v[static_cast<std::size_t>(count++)] = c;
  }
};

// Corners so little outside [m] are left in: equal boxes on one another would else gain and lose
// corners with every rounding error.
constexpr double kOnPlane = 1e-6;

// Keeps what lies below dot(n, p) <= offset. A cut is named by its plane and the corner before it.
Polygon clip(const Polygon& in, const Vec3& n, double offset, std::uint32_t plane) {
  Polygon out;
  for (int i = 0; i < in.count; ++i) {
    const ClipVertex& a = in.v[static_cast<std::size_t>(i)];
    const ClipVertex& b = in.v[static_cast<std::size_t>((i + 1) % in.count)];
    const double da = dot(n, a.p) - offset, db = dot(n, b.p) - offset;
    if (da <= kOnPlane) out.add(a);
    if ((da <= kOnPlane) != (db <= kOnPlane)) {
      out.add({a.p + (da / (da - db)) * (b.p - a.p), (a.feature & 3u) | (4u << plane)});
    }
  }
  return out;
}

// Four points that keep the extent of the polygon: the deepest, the farthest from it, and the two
// farthest to either side of the line between them.
void reduce(std::span<const ManifoldPoint> all, const Vec3& n, Manifold& m) {
  std::size_t first = 0, second = 0, left = 0, right = 0;
  for (std::size_t i = 1; i < all.size(); ++i) {
    if (all[i].separation < all[first].separation - 1e-7) first = i;
  }
  double most = -1.0;
  for (std::size_t i = 0; i < all.size(); ++i) {
    const Vec3 d = all[i].position - all[first].position;
    if (dot(d, d) > most) most = dot(d, d), second = i;
  }
  const Vec3 side = cross(n, all[second].position - all[first].position);
  double high = 0.0, low = 0.0;
  left = right = first;
  for (std::size_t i = 0; i < all.size(); ++i) {
    const double s = dot(side, all[i].position - all[first].position);
    if (s > high) high = s, left = i;
    if (s < low) low = s, right = i;
  }
  const std::size_t chosen[] = {first, second, left, right};
  for (std::size_t k = 0; k < 4; ++k) {
    const bool repeated = std::find(chosen, chosen + k, chosen[k]) != chosen + k;
    if (!repeated) m.points[m.count++] = all[chosen[k]];
  }
}

// n points out of the reference box towards the other.
void face_contact(const Vec3& h_ref, const SE3& T_ref, const Vec3& h_inc, const SE3& T_inc,
                  int axis, const Vec3& n, double margin, std::uint32_t name, Manifold& m) {
  const Mat3& I = T_inc.rotation();
  int face = 0;
  for (int k = 1; k < 3; ++k) {
    if (std::fabs(dot(axis_of(I, k), n)) > std::fabs(dot(axis_of(I, face), n))) face = k;
  }
  const int fu = (face + 1) % 3, fv = (face + 2) % 3;
  Polygon polygon;
  constexpr int kAround[4][2] = {{-1, -1}, {1, -1}, {1, 1}, {-1, 1}};
  for (std::uint32_t c = 0; c < 4; ++c) {
    Vec3 p;
    p[face] = dot(axis_of(I, face), n) > 0.0 ? -h_inc[face] : h_inc[face];
    p[fu] = kAround[c][0] * h_inc[fu];
    p[fv] = kAround[c][1] * h_inc[fv];
    polygon.add({T_inc * p, c});
  }
  for (int k = 0; k < 4 && polygon.count > 0; ++k) {
    const int side = (axis + 1 + k / 2) % 3;
    const Vec3 out = (k % 2 ? -1.0 : 1.0) * axis_of(T_ref.rotation(), side);
    polygon =
        clip(polygon, out, dot(out, T_ref.position()) + h_ref[side], static_cast<std::uint32_t>(k));
  }
  std::array<ManifoldPoint, 8> found;
  std::size_t count = 0;
  const double surface = dot(n, T_ref.position()) + h_ref[axis];
  for (int k = 0; k < polygon.count; ++k) {
    const ClipVertex& c = polygon.v[static_cast<std::size_t>(k)];
    const double separation = dot(n, c.p) - surface;
    if (separation > margin) continue;
    found[count++] = {c.p - 0.5 * separation * n, separation, (name << 8) | c.feature};
  }
  if (count <= kMaxPoints) {
    for (std::size_t k = 0; k < count; ++k) m.points[m.count++] = found[k];
  } else {
    reduce({found.data(), count}, n, m);
  }
}

}  // namespace

void collide_boxes(const Vec3& ha, const SE3& Ta, const Vec3& hb, const SE3& Tb, double margin,
                   Manifold& m) {
  BestAxis best;
  const Vec3 d = Tb.position() - Ta.position();
  if (!find_best_axis(ha, Ta.rotation(), hb, Tb.rotation(), d, margin, best)) return;
  m.normal = best.normal;
  if (best.j >= 0) {
    edge_contact(ha, Ta, hb, Tb, best, m);
  } else if (best.face_of_b) {
    face_contact(hb, Tb, ha, Ta, best.i, -best.normal, margin,
                 static_cast<std::uint32_t>(4 + best.i), m);
  } else {
    face_contact(ha, Ta, hb, Tb, best.i, best.normal, margin,
                 static_cast<std::uint32_t>(1 + best.i), m);
  }
}

}  // namespace vp::collide
