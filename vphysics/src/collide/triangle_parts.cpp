#include "collide/triangle_parts.h"

#include <utility>

namespace vp::collide {
namespace {

// Corners whose heights differ by less [fraction of the triangle's size] are equally far along.
constexpr double kSameHeight = 1e-6;
// Tolerance above a plane [fraction of the distance], for the rounding errors of directions.
constexpr double kBelow = 1e-6;

}  // namespace

bool face_towards(SurfaceTriangle& t, const Vec3& point, bool two_sided) {
  if (!(dot(t.normal, point - t.p[0]) < 0.0)) return true;
  if (!two_sided) return false;
  // Seen from behind: corners 0, 2, 1, and the edges 2, 1, 0.
  t.normal = -t.normal;
  std::swap(t.p[1], t.p[2]);
  std::swap(t.corners[1], t.corners[2]);
  std::swap(t.opposite[0], t.opposite[2]);
  std::swap(t.has_opposite[0], t.has_opposite[2]);
  const unsigned front = t.active & 7u, back = t.active >> 3;
  const auto reversed = [](unsigned bits) { return (bits & 2u) | (bits & 1u) << 2 | bits >> 2; };
  t.active = reversed(back) | reversed(front) << 3;
  return true;
}

// Source: Ericson, Real-Time Collision Detection, 2005, 5.1.5.
NearestOnTriangle nearest_on_triangle(const Vec3 p[3], const Vec3& q) {
  const Vec3 ab = p[1] - p[0], ac = p[2] - p[0], aq = q - p[0];
  const double d1 = dot(ab, aq), d2 = dot(ac, aq);
  if (d1 <= 0.0 && d2 <= 0.0) return {p[0], {TrianglePart::corner, 0}};
  const Vec3 bq = q - p[1];
  const double d3 = dot(ab, bq), d4 = dot(ac, bq);
  if (d3 >= 0.0 && d4 <= d3) return {p[1], {TrianglePart::corner, 1}};
  const double vc = d1 * d4 - d3 * d2;
  if (vc < 0.0 && d1 >= 0.0 && d3 <= 0.0) {
    return {p[0] + (d1 / (d1 - d3)) * ab, {TrianglePart::edge, 0}};
  }
  const Vec3 cq = q - p[2];
  const double d5 = dot(ab, cq), d6 = dot(ac, cq);
  if (d6 >= 0.0 && d5 <= d6) return {p[2], {TrianglePart::corner, 2}};
  const double vb = d5 * d2 - d1 * d6;
  if (vb < 0.0 && d2 >= 0.0 && d6 <= 0.0) {
    return {p[0] + (d2 / (d2 - d6)) * ac, {TrianglePart::edge, 2}};
  }
  const double va = d3 * d6 - d5 * d4;
  if (va < 0.0 && d4 - d3 >= 0.0 && d5 - d6 >= 0.0) {
    const double w = (d4 - d3) / ((d4 - d3) + (d5 - d6));
    return {p[1] + w * (p[2] - p[1]), {TrianglePart::edge, 1}};
  }
  const double k = 1.0 / (va + vb + vc);
  return {p[0] + (vb * k) * ab + (vc * k) * ac, {TrianglePart::face, 0}};
}

TrianglePart foremost_part(const Vec3 p[3], const Vec3& d) {
  const double h[3] = {0.0, dot(d, p[1] - p[0]), dot(d, p[2] - p[0])};
  const double top = std::max({h[0], h[1], h[2]});
  const double size = std::max(norm(p[1] - p[0]), norm(p[2] - p[0]));
  const auto bit = [&](int i) { return top - h[i] <= kSameHeight * size ? 1u << i : 0u; };
  constexpr TrianglePart kParts[8] = {
      {},
      {TrianglePart::corner, 0},
      {TrianglePart::corner, 1},
      {TrianglePart::edge, 0},
      {TrianglePart::corner, 2},
      {TrianglePart::edge, 2},
      {TrianglePart::edge, 1},
      {},
  };
  return kParts[bit(0) | bit(1) | bit(2)];
}

bool may_touch_along(const Surface& surface, const SurfaceTriangle& t, const TrianglePart& part,
                     const Vec3& d) {
  switch (part.kind) {
    case TrianglePart::face:
      return dot(d, t.normal) > 0.0;
    case TrianglePart::edge: {
      if (!is_active_edge(t, part.index)) return false;
      // A border: for the surface of a solid, only its outer side.
      if (!t.has_opposite[part.index]) return surface.two_sided() || dot(d, t.normal) >= -kBelow;
      const Vec3 offset = t.opposite[part.index] - t.p[part.index];
      return dot(d, offset) <= kBelow * norm(offset);
    }
    case TrianglePart::corner:
      break;
  }
  return (is_active_edge(t, part.index) || is_active_edge(t, (part.index + 2) % 3)) &&
         surface.lies_below(t.corners[part.index], d);
}

}  // namespace vp::collide
