// Both features are projected along the normal, and one is clipped to the other. The contact points
// are the corners of their intersection, with the separation of the two surfaces there.
//
// Source: Sutherland and Hodgman, Reentrant Polygon Clipping, 1974.
#include "collide/patch.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace vp::collide {
namespace {

// A corner this close to an edge or to another corner [fraction of the size] coincides with it:
// otherwise equal faces on each other would gain and lose corners with every rounding error.
constexpr double kCoincident = 1e-6;
// Depths that differ by less [fraction of the size] are equal.
constexpr double kSameDepth = 1e-6;
// The sine of the angle between two edges below which they touch along a segment.
constexpr double kAlongside = 1e-3;
// A face at a larger angle to the normal (cosine) cannot be the reference.
constexpr double kSteepest = 0.05;

// The kind of a point: a corner of a, of b, or the crossing of an edge of a and one of b.
enum : std::uint32_t { kCornerOfA = 1u << 30, kCornerOfB = 2u << 30, kCrossing = 3u << 30 };

// Coordinates perpendicular to the normal, and the height along it.
struct ClipCorner {
  double u, v, h;
  std::uint32_t name;
  int edge;  // the edge to the next corner: of the incident feature, or of_reference()
};
int of_reference(int edge) {
  return -1 - edge;
}

// An array of each number: small numbers that are stored one by one and loaded together have to
// wait for each other.
class ClipPolygon {
 public:
  int count() const { return count_; }
  void clear() { count_ = 0; }
  void add(const ClipCorner& c) {
    if (count_ == kMaxPatch) return;
    u_[count_] = c.u;
    v_[count_] = c.v;
    h_[count_] = c.h;
    name_[count_] = c.name;
    edge_[count_++] = c.edge;
  }
  ClipCorner operator[](int i) const { return {u_[i], v_[i], h_[i], name_[i], edge_[i]}; }
  void set_edge_of_last(int edge) { edge_[count_ - 1] = edge; }
  // The distance of corner i along (a, b) from (u, v).
  double along(int i, double a, double b, double u, double v) const {
    return a * (u_[i] - u) + b * (v_[i] - v);
  }

 private:
  int count_ = 0;
  double u_[kMaxPatch], v_[kMaxPatch], h_[kMaxPatch];
  std::uint32_t name_[kMaxPatch];
  int edge_[kMaxPatch];
};

struct Axes {
  Vec3 origin, u, v, n;  // right-handed

  Vec3 at(double pu, double pv, double ph) const { return origin + pu * u + pv * v + ph * n; }
};

Axes tangent_axes(const Vec3& n, const Vec3& origin) {
  int smallest = 0;
  for (int i = 1; i < 3; ++i) {
    if (std::fabs(n[i]) < std::fabs(n[smallest])) smallest = i;
  }
  Vec3 e;
  e[smallest] = 1.0;
  Vec3 u = cross(e, n);
  u = (1.0 / norm(u)) * u;
  return {origin, u, cross(n, u), n};
}

class Clipper {
 public:
  Clipper(const PatchQuery& query, const Axes& axes) : q_(query), axes_(axes) {}

  bool clip(bool ref_is_a);
  void clip_segment(bool ref_is_a);
  void along_segments();
  int count() const { return count_; }
  const PatchPoint* points() const { return points_; }

 private:
  const Feature& ref() const { return ref_is_a_ ? q_.a : q_.b; }
  const Feature& incident() const { return ref_is_a_ ? q_.b : q_.a; }
  ClipCorner projected(const FeatureCorner& c) const;
  void project_reference();
  // The distance outside of edge k times the edge's length. coincident_: the tolerance for this
  // product.
  double outside(int k, const ClipCorner& c) const {
    return rise_u_[k] * (c.u - ref_u_[k]) + rise_v_[k] * (c.v - ref_v_[k]);
  }
  std::uint32_t corner_name(bool of_a, int name) const {
    return (of_a ? kCornerOfA : kCornerOfB) | static_cast<std::uint32_t>(name);
  }
  std::uint32_t crossing_name(int incident_edge, int k) const;
  ClipCorner cut(const ClipCorner& from, const ClipCorner& to, double d_from, double d_to,
                 int k) const;
  bool cut_by_edge(int k, const ClipPolygon& in, ClipPolygon& out) const;
  double reference_height(double u, double v) const;
  void keep(const ClipCorner& c);
  void keep(double u, double v, double h_a, double h_b, std::uint32_t name);

  const PatchQuery& q_;
  const Axes& axes_;
  bool ref_is_a_ = true;
  int edges_ = 0;
  double ref_u_[kMaxCorners], ref_v_[kMaxCorners];
  double rise_u_[kMaxCorners], rise_v_[kMaxCorners];  // outward, with the edge's length
  double coincident_[kMaxCorners];
  double plane_u_ = 0.0, plane_v_ = 0.0, plane_0_ = 0.0;  // the reference's height
  PatchPoint points_[kMaxPatch];
  int count_ = 0;
};

ClipCorner Clipper::projected(const FeatureCorner& c) const {
  const Vec3 d = c.at() - axes_.origin;
  return {dot(axes_.u, d), dot(axes_.v, d), dot(axes_.n, d), 0, c.edge};
}

void Clipper::project_reference() {
  const Feature& f = ref();
  edges_ = f.count;
  ClipCorner first{};
  for (int k = 0; k < edges_; ++k) {
    const ClipCorner c = projected(f.corners[k]);
    if (k == 0) first = c;
    ref_u_[k] = c.u;
    ref_v_[k] = c.v;
  }
  const double sign = ref_is_a_ ? 1.0 : -1.0;  // b's faces have the opposite orientation
  for (int k = 0; k < edges_; ++k) {
    const int next = k + 1 < edges_ ? k + 1 : 0;
    rise_u_[k] = sign * (ref_v_[next] - ref_v_[k]);
    rise_v_[k] = -sign * (ref_u_[next] - ref_u_[k]);
    coincident_[k] = kCoincident * q_.size * (std::fabs(rise_u_[k]) + std::fabs(rise_v_[k]));
  }
  const Vec3 n = f.normal();
  const double inverse_cosine = 1.0 / dot(axes_.n, n);
  plane_u_ = -inverse_cosine * dot(axes_.u, n);
  plane_v_ = -inverse_cosine * dot(axes_.v, n);
  plane_0_ = first.h - plane_u_ * first.u - plane_v_ * first.v;
}

double Clipper::reference_height(double u, double v) const {
  return plane_0_ + plane_u_ * u + plane_v_ * v;
}

std::uint32_t Clipper::crossing_name(int incident_edge, int k) const {
  const auto e = static_cast<std::uint32_t>(incident_edge);
  const std::uint32_t r = ref().corners[k].edge;
  return kCrossing | (ref_is_a_ ? (r << 15) | e : (e << 15) | r);
}

// The crossing between a corner inside edge k and one outside.
ClipCorner Clipper::cut(const ClipCorner& from, const ClipCorner& to, double d_from, double d_to,
                        int k) const {
  const double t = d_from / (d_from - d_to);
  ClipCorner c{from.u + t * (to.u - from.u), from.v + t * (to.v - from.v),
               from.h + t * (to.h - from.h), 0, from.edge};
  if (from.edge >= 0) {
    c.name = crossing_name(from.edge, k);
  } else {  // along a reference edge to the next one: their common corner
    const int j = of_reference(from.edge);
    const int shared = j + 1 == k || (k == 0 && j == edges_ - 1) ? k : j;
    c.name = corner_name(ref_is_a_, ref().corners[shared].name);
  }
  return c;
}

// Returns false if nothing is outside of edge k: `out` is not written then.
bool Clipper::cut_by_edge(int k, const ClipPolygon& in, ClipPolygon& out) const {
  const double on = coincident_[k];
  double distance[kMaxPatch];
  bool some_outside = false;
  for (int i = 0; i < in.count(); ++i) {
    distance[i] = in.along(i, rise_u_[k], rise_v_[k], ref_u_[k], ref_v_[k]);
    some_outside = some_outside || distance[i] > on;
  }
  if (!some_outside) return false;
  out.clear();
  for (int i = 0; i < in.count(); ++i) {
    const int after = i + 1 < in.count() ? i + 1 : 0;
    const double d = distance[i], d_next = distance[after];
    if (d <= on) out.add(in[i]);
    if (d_next > on && d <= on) {  // leaves
      if (d < -on) out.add(cut(in[i], in[after], d, d_next, k));
      out.set_edge_of_last(of_reference(k));
    } else if (d > on && d_next < -on) {  // enters
      out.add(cut(in[i], in[after], d, d_next, k));
    }
  }
  return true;
}

void Clipper::keep(double u, double v, double h_a, double h_b, std::uint32_t name) {
  const double separation = h_b - h_a - q_.radius_a - q_.radius_b;
  if (separation > q_.margin || count_ == kMaxPatch) return;
  const Vec3 p = axes_.at(u, v, h_a + q_.radius_a + 0.5 * separation);
  points_[count_++] = {p.x, p.y, p.z, separation, name};
}

void Clipper::keep(const ClipCorner& c) {
  const double h = reference_height(c.u, c.v);
  keep(c.u, c.v, ref_is_a_ ? h : c.h, ref_is_a_ ? c.h : h, c.name);
}

// Clips a polygon to a polygon. Returns false if nothing is left.
bool Clipper::clip(bool ref_is_a) {
  ref_is_a_ = ref_is_a;
  project_reference();
  ClipPolygon one, two;
  ClipPolygon *in = &one, *out = &two;
  const Feature& f = incident();
  for (int i = 0; i < f.count; ++i) {
    ClipCorner c = projected(f.corners[i]);
    c.name = corner_name(!ref_is_a_, f.corners[i].name);
    in->add(c);
  }
  for (int k = 0; k < edges_ && in->count() > 0; ++k) {
    if (cut_by_edge(k, *in, *out)) std::swap(in, out);
  }
  for (int i = 0; i < in->count(); ++i) keep((*in)[i]);
  return in->count() > 0;
}

// Clips a segment or a point to a polygon.
void Clipper::clip_segment(bool ref_is_a) {
  ref_is_a_ = ref_is_a;
  project_reference();
  const Feature& f = incident();
  const ClipCorner p = projected(f.corners[0]), q = projected(f.corners[f.count - 1]);
  double first = 0.0, last = 1.0;
  int first_edge = -1, last_edge = -1;
  for (int k = 0; k < edges_; ++k) {
    const double on = coincident_[k];
    const double dp = outside(k, p), dq = outside(k, q);
    if (dp > on && dq > on) return;
    if (dp > on) {
      const double t = dp / (dp - dq);
      if (t > first) first = t, first_edge = k;
    } else if (dq > on) {
      const double t = dp / (dp - dq);
      if (t < last) last = t, last_edge = k;
    }
  }
  if (first > last) return;
  const auto end = [&](double t, int edge, const FeatureCorner& corner) {
    const std::uint32_t name =
        edge < 0 ? corner_name(!ref_is_a_, corner.name) : crossing_name(f.corners[0].edge, edge);
    keep({p.u + t * (q.u - p.u), p.v + t * (q.v - p.v), p.h + t * (q.h - p.h), name, 0});
  };
  end(first, first_edge, f.corners[0]);
  if (f.count > 1) end(last, last_edge, f.corners[1]);
}

// The overlap of two parallel segments. Crossing ones have a single point, which is already known.
void Clipper::along_segments() {
  if (q_.a.count != 2 || q_.b.count != 2) return;
  const ClipCorner a0 = projected(q_.a.corners[0]), a1 = projected(q_.a.corners[1]),
                   b0 = projected(q_.b.corners[0]), b1 = projected(q_.b.corners[1]);
  const double au = a1.u - a0.u, av = a1.v - a0.v, bu = b1.u - b0.u, bv = b1.v - b0.v;
  const double aa = au * au + av * av, bb = bu * bu + bv * bv;
  const double sine = au * bv - av * bu, cosine = au * bu + av * bv;
  if (!(sine * sine <= kAlongside * kAlongside * aa * bb) || !(aa > 0.0) || !(bb > 0.0)) return;
  // The coordinate along a, from 0 to 1.
  const auto along_a = [&](const ClipCorner& c) {
    return ((c.u - a0.u) * au + (c.v - a0.v) * av) / aa;
  };
  const double s0 = along_a(b0), s1 = along_a(b1);
  const auto point = [&](double s, std::uint32_t name) {
    const double t = std::clamp((s - s0) / (s1 - s0), 0.0, 1.0);
    const double h_b = b0.h + t * (b1.h - b0.h);
    keep(a0.u + s * au, a0.v + s * av, a0.h + s * (a1.h - a0.h), h_b, name);
  };
  const bool same_direction = cosine > 0.0;
  const double low = same_direction ? s0 : s1, high = same_direction ? s1 : s0;
  const FeatureCorner& b_low = q_.b.corners[same_direction ? 0 : 1];
  const FeatureCorner& b_high = q_.b.corners[same_direction ? 1 : 0];
  if (!(low < 1.0) || !(high > 0.0)) return;
  low > 0.0 ? point(low, corner_name(false, b_low.name))
            : point(0.0, corner_name(true, q_.a.corners[0].name));
  high < 1.0 ? point(high, corner_name(false, b_high.name))
             : point(1.0, corner_name(true, q_.a.corners[1].name));
}

// Removes the flattest corner repeatedly until eight are left, but never the last of the deepest.
int thin_out(const PatchPoint* points, int count, const Vec3& n, double deep, int* kept_points) {
  int deep_ones = 0;
  for (int i = 0; i < count; ++i) {
    kept_points[i] = i;
    deep_ones += points[i].separation <= deep ? 1 : 0;
  }
  constexpr double kClearlyFlatter = 1.0 - 1e-3;
  for (; count > 8; --count) {
    int flattest = -1;
    double smallest = 0.0;
    for (int i = 0; i < count; ++i) {
      const PatchPoint& here = points[kept_points[i]];
      if (here.separation <= deep && deep_ones == 1) continue;
      const Vec3 before = points[kept_points[(i + count - 1) % count]].at(),
                 after = points[kept_points[(i + 1) % count]].at();
      const double area = std::fabs(dot(n, cross(here.at() - before, after - before)));
      if (flattest < 0 || area < smallest * kClearlyFlatter) {
        flattest = i;
        smallest = area;
      }
    }
    deep_ones -= points[kept_points[flattest]].separation <= deep ? 1 : 0;
    std::copy(kept_points + flattest + 1, kept_points + count, kept_points + flattest);
  }
  return count;
}

void append(Manifold& m, const PatchPoint& p) {
  m.add(p.at(), p.separation, p.name);
}

}  // namespace

void reduce_patch(const PatchPoint* points, int count, const Vec3& n, double size, Manifold& m) {
  if (count <= kMaxPoints) {
    for (int i = 0; i < count; ++i) append(m, points[i]);
    return;
  }
  double deep = points[0].separation;
  for (int i = 1; i < count; ++i) deep = std::min(deep, points[i].separation);
  deep += kSameDepth * size;
  int kept_points[kMaxPatch];
  count = thin_out(points, count, n, deep, kept_points);
  // The largest quadrilateral that contains a deep corner; of equal ones the first. Twice its area
  // is the product of the diagonals.
  constexpr double kClearlyWider = 1.0 + 1e-3;
  double widest = -1.0;
  int best[4] = {0, 1, 2, 3};
  const auto at = [&](int i) -> const PatchPoint& { return points[kept_points[i]]; };
  for (int i = 0; i < count; ++i) {
    for (int k = i + 2; k < count; ++k) {
      const Vec3 perpendicular = cross(n, at(k).at() - at(i).at());
      for (int j = i + 1; j < k; ++j) {
        for (int l = k + 1; l < count; ++l) {
          const bool has_deep = at(i).separation <= deep || at(j).separation <= deep ||
                                at(k).separation <= deep || at(l).separation <= deep;
          const double area = std::fabs(dot(perpendicular, at(l).at() - at(j).at()));
          if (!has_deep || !(area > widest * kClearlyWider)) continue;
          widest = area;
          best[0] = i, best[1] = j, best[2] = k, best[3] = l;
        }
      }
    }
  }
  for (const int i : best) append(m, at(i));
}

void find_patch(const PatchQuery& q, bool with_nearest, Manifold& m) {
  const Axes axes = tangent_axes(q.normal, q.on_a);
  Clipper clipper(q, axes);
  const double flat_a = q.a.count >= 3 ? dot(q.a.normal(), q.normal) : 0.0;
  const double flat_b = q.b.count >= 3 ? -dot(q.b.normal(), q.normal) : 0.0;
  if (std::max(flat_a, flat_b) > kSteepest) {
    const bool ref_is_a = flat_a >= flat_b;
    if ((ref_is_a ? q.b : q.a).count >= 3) {
      (void)clipper.clip(ref_is_a);
    } else {
      clipper.clip_segment(ref_is_a);
    }
  } else {
    clipper.along_segments();
  }
  reduce_patch(clipper.points(), clipper.count(), q.normal, q.size, m);
  // If the features are not exactly those that touch, the closest points are added.
  const double separation = q.core_separation - q.radius_a - q.radius_b;
  if (!with_nearest || separation > q.margin) return;
  for (int i = 0; i < m.count; ++i) {
    if (m.points[i].separation <= separation + kSameDepth * q.size) return;
  }
  const Vec3 surface = q.on_a + (q.radius_a + 0.5 * separation) * q.normal;
  if (m.count < kMaxPoints) {
    m.add(surface, separation, 0);
  } else {
    m.points[kMaxPoints - 1] = {surface, separation, 0};
  }
}

}  // namespace vp::collide
