// Manifolds of every pair of shapes except box against box. Each routine takes the shapes in the
// order of Kind; find_manifold turns the pair and, at the end, the normal around.
#include <algorithm>
#include <cmath>
#include <utility>

#include "collide/manifold.h"

namespace vp::collide {
namespace {

struct Posed {
  const Geometry& g;
  const SE3& T;
};

// A sphere at centre against any convex shape b. The manifold's normal is set from a to b.
void sphere_against(const Vec3& centre, double radius, const Posed& b, double margin,
                    std::uint32_t feature, Manifold& m) {
  const SignedDistance d = signed_distance(b.g, inverse_times(b.T, centre));
  const double separation = d.distance - radius;
  if (separation > margin) return;
  m.normal = -b.T.rotate(d.normal);
  m.add(centre + (radius + 0.5 * separation) * m.normal, separation, feature);
}

Vec3 on_axis(const Posed& capsule, double s) {
  return capsule.T.position() + s * capsule.T.rotation().cz;
}

struct AxisPair {
  double s, t;
};
// Parameters of the points of two segments (s on a, t on b) that are nearest to one another.
AxisPair closest_on_axes(const Posed& a, const Posed& b) {
  const Vec3 da = a.T.rotation().cz, db = b.T.rotation().cz;
  const Vec3 r = a.T.position() - b.T.position();
  const double la = a.g.half.z, lb = b.g.half.z;
  const double k = dot(da, db), ra = dot(da, r), rb = dot(db, r);
  const double parallel = 1.0 - k * k;
  double s = parallel > 1e-12 ? std::clamp((k * rb - ra) / parallel, -la, la) : 0.0;
  const double t = std::clamp(k * s + rb, -lb, lb);
  s = std::clamp(k * t - ra, -la, la);
  return {s, std::clamp(k * s + rb, -lb, lb)};
}

// Capsules that lie along one another touch along a stretch: its two ends carry them.
void capsule_capsule(const Posed& a, const Posed& b, double margin, Manifold& m) {
  const Vec3 da = a.T.rotation().cz, db = b.T.rotation().cz;
  const AxisPair nearest = closest_on_axes(a, b);
  const Vec3 d = on_axis(b, nearest.t) - on_axis(a, nearest.s);
  const double distance = norm(d);
  const double separation = distance - a.g.radius - b.g.radius;
  if (separation > margin) return;
  m.normal = distance > 1e-12 ? (1.0 / distance) * d : a.T.rotation().cx;
  constexpr double kAlongside = 1e-3;  // sine of the angle below which two points are used
  const double along = dot(da, db);
  if (norm(cross(da, db)) < kAlongside && a.g.half.z > 0.0 && b.g.half.z > 0.0) {
    const double centre = dot(da, b.T.position() - a.T.position());
    const double lower = std::max(-a.g.half.z, centre - b.g.half.z);
    const double upper = std::min(a.g.half.z, centre + b.g.half.z);
    if (upper > lower) {
      for (int i = 0; i < 2; ++i) {
        const double s = i == 0 ? lower : upper;
        const Vec3 pa = on_axis(a, s);
        const Vec3 pb = on_axis(b, std::clamp((s - centre) * along, -b.g.half.z, b.g.half.z));
        const double gap = dot(m.normal, pb - pa) - a.g.radius - b.g.radius;
        if (gap <= margin) {
          m.add(pa + (a.g.radius + 0.5 * gap) * m.normal, gap, static_cast<std::uint32_t>(i + 1));
        }
      }
      return;
    }
  }
  m.add(on_axis(a, nearest.s) + (a.g.radius + 0.5 * separation) * m.normal, separation, 0);
}

// The signed distance to a convex shape is convex along the capsule's axis: bisection on its slope
// finds the nearest point; the ends are added so that a lying capsule does not rock.
void capsule_against(const Posed& a, const Posed& b, double margin, Manifold& m) {
  const Vec3 axis = b.T.unrotate(a.T.rotation().cz);
  const Vec3 middle = inverse_times(b.T, a.T.position());
  double lower = -a.g.half.z, upper = a.g.half.z;
  constexpr int kHalvings = 48;  // down to 1e-14 of the length
  for (int i = 0; i < kHalvings && lower < upper; ++i) {
    const double s = 0.5 * (lower + upper);
    const double slope = dot(signed_distance(b.g, middle + s * axis).normal, axis);
    (slope > 0.0 ? upper : lower) = s;
  }
  const double nearest = 0.5 * (lower + upper);
  Manifold ends;
  sphere_against(on_axis(a, nearest), a.g.radius, b, margin, 0, ends);
  if (ends.count == 0) return;
  const Vec3 normal = ends.normal;
  // Ends beside the nearest point, and only where they face the same surface, carry as well.
  for (int i = 0; i < 2; ++i) {
    const double s = i == 0 ? -a.g.half.z : a.g.half.z;
    if (std::fabs(s - nearest) < 0.05 * a.g.radius) continue;
    const SignedDistance d = signed_distance(b.g, middle + s * axis);
    const Vec3 n = -b.T.rotate(d.normal);
    if (dot(n, normal) < 0.99 || d.distance - a.g.radius > margin) continue;
    const double gap = d.distance - a.g.radius;
    m.add(on_axis(a, s) + (a.g.radius + 0.5 * gap) * n, gap, static_cast<std::uint32_t>(i + 1));
  }
  m.normal = normal;
  if (m.count < 2) m.add(ends.points[0].position, ends.points[0].separation, 0);
}

// The four corners of the face that looks into the half-space most: among them is the deepest.
void box_half_space(const Posed& a, const Posed& b, double margin, Manifold& m) {
  const Vec3 up = b.T.rotation().cz;
  const Vec3 n = a.T.unrotate(up);
  int axis = 0;
  for (int i = 1; i < 3; ++i) {
    if (std::fabs(n[i]) > std::fabs(n[axis])) axis = i;
  }
  m.normal = -up;
  for (std::uint32_t corner = 0; corner < 4; ++corner) {
    Vec3 p;
    p[axis] = n[axis] > 0.0 ? -a.g.half[axis] : a.g.half[axis];
    const int u = (axis + 1) % 3, v = (axis + 2) % 3;
    p[u] = corner & 1u ? a.g.half[u] : -a.g.half[u];
    p[v] = corner & 2u ? a.g.half[v] : -a.g.half[v];
    const Vec3 world = a.T * p;
    const double separation = dot(up, world - b.T.position());
    const auto feature = static_cast<std::uint32_t>(8 * axis + (n[axis] > 0.0 ? 4 : 0)) + corner;
    if (separation <= margin) m.add(world - 0.5 * separation * up, separation, feature);
  }
}

void collide_ordered(const Posed& a, const Posed& b, double margin, Manifold& m) {
  if (a.g.kind == Kind::sphere) {
    sphere_against(a.T.position(), a.g.radius, b, margin, 0, m);
  } else if (a.g.kind == Kind::capsule) {
    b.g.kind == Kind::capsule ? capsule_capsule(a, b, margin, m) : capsule_against(a, b, margin, m);
  } else if (b.g.kind == Kind::box) {
    collide_boxes(a.g.half, a.T, b.g.half, b.T, margin, m);
  } else if (a.g.kind == Kind::box) {
    box_half_space(a, b, margin, m);
  }
}

}  // namespace

void find_manifold(const Geometry& a, const SE3& T_a, const Geometry& b, const SE3& T_b,
                   double margin, Manifold& manifold) {
  manifold.count = 0;
  if (a.kind <= b.kind) {
    collide_ordered({a, T_a}, {b, T_b}, margin, manifold);
  } else {
    collide_ordered({b, T_b}, {a, T_a}, margin, manifold);
    manifold.normal = -manifold.normal;
  }
}

}  // namespace vp::collide
