// The point v of a simplex in A - B that is closest to the origin converges to the closest point of
// A - B. Each iteration adds the support point w in the direction -v and keeps the simplex points
// that v depends on. v . w / |v| is a lower bound of the distance, |v| an upper one.
//
// Source: van den Bergen, A Fast and Robust GJK Implementation for Collision Detection of Convex
// Objects, 1999; closest points of triangles: Ericson, Real-Time Collision Detection, 2005, 5.1.5.
#include "collide/gjk.h"

#include <limits>

namespace vp::collide {
namespace {

constexpr int kMaxIterations = 96;
// Convergence: the maximum difference of the bounds [fraction of the distance, squared]. Normals
// are accurate to its square root.
constexpr double kRelative = 1e-14;
// Rounding error of a support point [fraction of the pair's extent].
constexpr double kRounding = 4e-16;
// Rounding error of six products of three differences [fraction of the largest].
constexpr double kDoubt = 2e-15;
// Below this distance [fraction of the extent] the direction is undefined.
constexpr double kTouching = 1e-11;

// The part of a simplex that is closest to the origin.
struct Nearest {
  Vec3 v;
  double weight[4];
  int index[4];
  int count = 0;

  void add(int i, double w) {
    index[count] = i;
    weight[count++] = w;
  }
};

Nearest at_vertex(const Simplex& s, int i) {
  Nearest n;
  n.v = s.p[i].w;
  n.add(i, 1.0);
  return n;
}

Nearest on_segment(const Simplex& s, int i, int k) {
  const Vec3 a = s.p[i].w, ab = s.p[k].w - a;
  const double along = -dot(a, ab), length = dot(ab, ab);
  if (!(along > 0.0)) return at_vertex(s, i);
  if (!(along < length)) return at_vertex(s, k);
  const double t = along / length;
  Nearest n;
  n.v = a + t * ab;
  n.add(i, 1.0 - t);
  n.add(k, t);
  return n;
}

const Nearest& nearer(const Nearest& a, const Nearest& b) {
  return dot(b.v, b.v) < dot(a.v, a.v) ? b : a;
}

Nearest on_triangle(const Simplex& s, int i, int k, int l) {
  const Vec3 a = s.p[i].w, b = s.p[k].w, c = s.p[l].w;
  const Vec3 n = cross(b - a, c - a);
  // Barycentric weights times n . n: each the part of the area opposite a corner.
  const double wa = dot(n, cross(b, c)), wb = dot(n, cross(c, a)), wc = dot(n, cross(a, b));
  const double nn = dot(n, n);
  if (wa > 0.0 && wb > 0.0 && wc > 0.0 && nn > 0.0) {
    Nearest found;
    const double k1 = 1.0 / (wa + wb + wc);
    found.v = (dot(n, a) / nn) * n;
    found.add(i, wa * k1);
    found.add(k, wb * k1);
    found.add(l, wc * k1);
    return found;
  }
  // Beyond an edge, or the triangle is too thin: the closest of its edges.
  const Nearest ab = on_segment(s, i, k), bc = on_segment(s, k, l), ca = on_segment(s, l, i);
  return nearer(nearer(ab, bc), ca);
}

// count is 4 if the origin is inside.
Nearest in_tetrahedron(const Simplex& s) {
  constexpr int kFaces[4][4] = {{0, 1, 2, 3}, {0, 3, 1, 2}, {0, 2, 3, 1}, {1, 3, 2, 0}};
  Nearest best;
  double smallest = std::numeric_limits<double>::infinity();
  double largest = 0.0;
  for (int i = 0; i < 4; ++i) largest = std::max(largest, dot(s.p[i].w, s.p[i].w));
  for (const auto& f : kFaces) {
    const Vec3 a = s.p[f[0]].w, ab = s.p[f[1]].w - a, ac = s.p[f[2]].w - a, n = cross(ab, ac);
    // The origin is clearly on the inner side of the face. Nearly identical corners make faces that
    // are rounding noise.
    const double opposite = dot(n, s.p[f[3]].w - a), origin = -dot(n, a);
    const double doubt = kDoubt * largest * (norm(ab) + norm(ac));
    if ((opposite > doubt && origin > doubt) || (opposite < -doubt && origin < -doubt)) continue;
    const Nearest on_face = on_triangle(s, f[0], f[1], f[2]);
    const double d2 = dot(on_face.v, on_face.v);
    if (d2 < smallest) {
      smallest = d2;
      best = on_face;
    }
  }
  if (best.count == 0) {
    for (int i = 0; i < 4; ++i) best.add(i, 0.25);
  }
  return best;
}

Nearest nearest_of(const Simplex& s) {
  switch (s.count) {
    case 1:
      return at_vertex(s, 0);
    case 2:
      return on_segment(s, 0, 1);
    case 3:
      return on_triangle(s, 0, 1, 2);
    default:
      return in_tetrahedron(s);
  }
}

void keep(Simplex& s, const Nearest& n) {
  Simplex kept_points;
  for (int i = 0; i < n.count; ++i) {
    kept_points.p[i] = s.p[n.index[i]];
    kept_points.weight[i] = n.weight[i];
  }
  kept_points.count = n.count;
  s = kept_points;
}

bool contains(const Simplex& s, const Vec3& w) {
  for (int i = 0; i < s.count; ++i) {
    if (s.p[i].w == w) return true;
  }
  return false;
}

void set_separated(GjkResult& r, const Vec3& v, double distance) {
  r.state = GjkResult::State::separated;
  r.distance = distance;
  r.normal = (-1.0 / distance) * v;
  r.on_a = r.on_b = {};
  for (int i = 0; i < r.simplex.count; ++i) {
    r.on_a += r.simplex.weight[i] * r.simplex.p[i].a;
    r.on_b += r.simplex.weight[i] * r.simplex.p[i].b();
  }
}

}  // namespace

GjkResult gjk(const CorePair& pair, const Vec3& start, const CorePoint& first, double limit) {
  GjkResult r;
  r.state = GjkResult::State::overlaps;
  CorePoint next = first;
  const double first_separation = -dot(start, next.w);
  if (first_separation > limit) {
    r.state = GjkResult::State::beyond;
    r.distance = first_separation;
    r.normal = start;
    return r;
  }
  r.simplex.p[0] = next;
  r.simplex.weight[0] = 1.0;
  r.simplex.count = 1;
  Vec3 v = next.w;
  double v2 = dot(v, v);
  const double touching = kTouching * pair.extent;
  for (int iteration = 0; iteration < kMaxIterations; ++iteration) {
    if (v2 <= touching * touching) return r;
    const double length = std::sqrt(v2);
    const Vec3 n = (-1.0 / length) * v;
    next = support_of(pair, n);
    const double separation = -dot(n, next.w);  // v . w / |v|
    if (separation > limit) {
      r.state = GjkResult::State::beyond;
      r.distance = separation;
      r.normal = n;
      return r;
    }
    const double closed = kRelative * length + kRounding * pair.extent;
    if (length - separation <= closed) {
      set_separated(r, v, length);
      return r;
    }
    // If rounding errors end the search, v is the closest point within accuracy; but only a
    // positive separation proves that they are separated.
    if (contains(r.simplex, next.w)) {
      if (separation > 0.0) set_separated(r, v, length);
      return r;
    }
    r.simplex.p[r.simplex.count++] = next;
    const Nearest nearest = nearest_of(r.simplex);
    if (nearest.count == 4) {
      r.simplex.count = 4;
      return r;
    }
    const double n2 = dot(nearest.v, nearest.v);
    if (!(n2 < v2)) {
      --r.simplex.count;
      if (separation > 0.0) set_separated(r, v, length);
      return r;
    }
    keep(r.simplex, nearest);
    v = nearest.v;
    v2 = n2;
  }
  const double length = std::sqrt(v2), separation = separation_along(pair, (-1.0 / length) * v);
  pair.rough |= length - separation > kRough * pair.size;
  if (separation > 0.0) set_separated(r, v, length);
  return r;
}

}  // namespace vp::collide
