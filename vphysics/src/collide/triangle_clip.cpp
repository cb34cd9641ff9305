// Source: Sutherland and Hodgman, Reentrant Polygon Clipping, 1974.
#include "collide/triangle_clip.h"

#include <utility>

namespace vp::collide {
namespace {

// A corner this close to a side of the triangle [fraction of the size] is on it.
constexpr double kOnSide = 1e-6;

struct TrimCorner {
  Vec3 p;
  std::uint32_t name;
  std::uint32_t edge;  // to the next corner: of the feature, or kTriangleSide + the triangle's
};
constexpr std::uint32_t kTriangleSide = 1u << 15, kCrossed = 1u << 19, kCornerOfTriangle = 1u << 20;

// Each side adds at most one corner.
constexpr int kMaxTrimmed = kMaxCorners + 3;

struct Trimmed {
  int count = 0;
  TrimCorner corners[kMaxTrimmed];
  void add(const TrimCorner& c) {
    if (count < kMaxTrimmed) corners[count++] = c;
  }
};

struct SidePlane {
  Vec3 outward, on;
  double above(const Vec3& q) const { return dot(outward, q - on); }
};

SidePlane side(const ClipQuery& q, int k) {
  const Vec3 c = cross(q.p[(k + 1) % 3] - q.p[k], q.n);
  return {(1.0 / norm(c)) * c, q.p[k]};
}

// The name of the crossing of a feature's edge and side k; or of the corner between sides j and k.
std::uint32_t crossing(std::uint32_t edge, int k) {
  if (edge < kTriangleSide) return kCrossed | edge << 2 | static_cast<std::uint32_t>(k);
  const int j = static_cast<int>(edge - kTriangleSide);
  return kCornerOfTriangle | static_cast<std::uint32_t>((j + 1) % 3 == k ? k : j);
}

TrimCorner cut_between(const TrimCorner& from, const TrimCorner& to, double d_from, double d_to,
                       int k) {
  return {from.p + (d_from / (d_from - d_to)) * (to.p - from.p), crossing(from.edge, k), from.edge};
}

void trim(const Trimmed& in, const SidePlane& plane, int k, double on, Trimmed& out) {
  out.count = 0;
  for (int i = 0; i < in.count; ++i) {
    const TrimCorner& here = in.corners[i];
    const TrimCorner& next = in.corners[i + 1 < in.count ? i + 1 : 0];
    const double d = plane.above(here.p), d_next = plane.above(next.p);
    if (d <= on) out.add(here);
    if (d <= on && d_next > on) {  // leaves
      if (d < -on) out.add(cut_between(here, next, d, d_next, k));
      if (out.count > 0)
        out.corners[out.count - 1].edge = kTriangleSide + static_cast<std::uint32_t>(k);
    } else if (d > on && d_next < -on) {  // enters
      out.add(cut_between(here, next, d, d_next, k));
    }
  }
}

// A segment has no interior: its ends move.
void trim_segment(Trimmed& s, const SidePlane& plane, int k, double on) {
  const double d0 = plane.above(s.corners[0].p), d1 = plane.above(s.corners[1].p);
  if (d0 > on && d1 > on) {
    s.count = 0;
  } else if (d0 > on) {
    s.corners[0] = cut_between(s.corners[0], s.corners[1], d0, d1, k);
  } else if (d1 > on) {
    s.corners[1] = cut_between(s.corners[0], s.corners[1], d0, d1, k);
  }
}

}  // namespace

void append_clipped(const ClipQuery& q, std::vector<ManifoldPoint>& points) {
  Trimmed one, two;
  Trimmed *in = &one, *out = &two;
  for (int i = 0; i < q.feature.count; ++i) {
    const FeatureCorner& c = q.feature.corners[i];
    in->add({c.at(), c.name, c.edge});
  }
  const double on = kOnSide * q.size;
  for (int k = 0; k < 3 && in->count > 0; ++k) {
    const SidePlane plane = side(q, k);
    if (in->count == 1) {
      if (plane.above(in->corners[0].p) > on) in->count = 0;
    } else if (q.feature.count == 2) {
      trim_segment(*in, plane, k, on);
    } else {
      trim(*in, plane, k, on, *out);
      std::swap(in, out);
    }
  }
  for (int i = 0; i < in->count; ++i) {
    const Vec3& p = in->corners[i].p;
    const double separation = dot(q.n, p - q.p[0]) - q.radius;
    if (separation > q.margin) continue;
    points.push_back({p - (q.radius + 0.5 * separation) * q.n, separation, in->corners[i].name});
  }
}

}  // namespace vp::collide
