// Manifolds of every pair of convex shapes. Closed forms are here, the others are in
// convex_contact.h. Each routine takes the shapes in the order of Kind; find_manifold swaps the
// pair and, at the end, reverses the normal.
#include <algorithm>
#include <cmath>
#include <utility>

#include "collide/bounds.h"
#include "collide/capsule_axes.h"
#include "collide/convex_contact.h"
#include "collide/manifold.h"

namespace vp::collide {
namespace {

struct Posed {
  const Geometry& g;
  const SE3& T;
};

// A sphere at centre against any convex shape b. The normal points from a to b.
void sphere_against(const Vec3& centre, double radius, const Posed& b, double margin,
                    std::uint32_t feature, Manifold& m) {
  const SignedDistance d = signed_distance(b.g, inverse_times(b.T, centre));
  const double separation = d.distance - radius;
  m.min_separation = separation;
  if (separation > margin) return;
  m.normal = -b.T.rotate(d.normal);
  m.add(centre + (radius + 0.5 * separation) * m.normal, separation, feature);
}

Axis axis_of(const Posed& capsule) {
  return {capsule.T.position(), capsule.T.rotation().cz, capsule.g.half.z};
}

// Parallel capsules touch along a segment: its two ends are the contact points.
void capsule_capsule(const Posed& a, const Posed& b, double margin, Manifold& m) {
  const Axis axis_a = axis_of(a), axis_b = axis_of(b);
  const Vec3 &da = axis_a.direction, &db = axis_b.direction;
  const AxisPair nearest = nearest_on_axes(axis_a, axis_b);
  const Vec3 d = axis_b.at(nearest.t) - axis_a.at(nearest.s);
  const double separation = norm(d) - a.g.radius - b.g.radius;
  m.min_separation = separation;
  if (separation > margin) return;
  m.normal = normal_between(axis_a, axis_b, d);
  constexpr double kAlongside = 1e-3;  // sine of the angle below which two points are used
  const double along = dot(da, db);
  if (norm(cross(da, db)) < kAlongside && a.g.half.z > 0.0 && b.g.half.z > 0.0) {
    const double centre = dot(da, b.T.position() - a.T.position());
    const double lower = std::max(-a.g.half.z, centre - b.g.half.z);
    const double upper = std::min(a.g.half.z, centre + b.g.half.z);
    if (upper > lower) {
      for (int i = 0; i < 2; ++i) {
        const double s = i == 0 ? lower : upper;
        const Vec3 pa = axis_a.at(s);
        const Vec3 pb = axis_b.at(std::clamp((s - centre) * along, -b.g.half.z, b.g.half.z));
        const double at_point = dot(m.normal, pb - pa) - a.g.radius - b.g.radius;
        if (at_point <= margin) {
          m.add(pa + (a.g.radius + 0.5 * at_point) * m.normal, at_point,
                static_cast<std::uint32_t>(i + 1));
        }
      }
      return;
    }
  }
  m.add(axis_a.at(nearest.s) + (a.g.radius + 0.5 * separation) * m.normal, separation, 0);
}

// The four corners of the face that faces the half-space most: the deepest corner is among them.
void box_half_space(const Posed& a, const Posed& b, double margin, Manifold& m) {
  const Vec3 up = b.T.rotation().cz;
  const Vec3 n = a.T.unrotate(up);
  int axis = 0;
  for (int i = 1; i < 3; ++i) {
    if (std::fabs(n[i]) > std::fabs(n[axis])) axis = i;
  }
  m.normal = -up;
  m.min_separation = kFar;
  for (std::uint32_t corner = 0; corner < 4; ++corner) {
    Vec3 p;
    p[axis] = n[axis] > 0.0 ? -a.g.half[axis] : a.g.half[axis];
    const int u = (axis + 1) % 3, v = (axis + 2) % 3;
    p[u] = corner & 1u ? a.g.half[u] : -a.g.half[u];
    p[v] = corner & 2u ? a.g.half[v] : -a.g.half[v];
    const Vec3 world = a.T * p;
    const double separation = dot(up, world - b.T.position());
    m.min_separation = std::min(m.min_separation, separation);
    const auto feature = static_cast<std::uint32_t>(8 * axis + (n[axis] > 0.0 ? 4 : 0)) + corner;
    if (separation <= margin) m.add(world - 0.5 * separation * up, separation, feature);
  }
}

// The corners of the lowest feature.
void lowest_half_space(const Posed& a, const Posed& b, double margin, Manifold& m) {
  const Vec3 up = b.T.rotation().cz;
  const SE3 turned(a.T.rotation(), {});  // the position is added last, since it may be large
  const double height = dot(up, a.T.position() - b.T.position()) - core_radius(a.g);
  Feature feature;
  find_feature(a.g, turned, -a.T.unrotate(up), feature);
  PatchPoint found[kMaxCorners];
  int count = 0;
  m.min_separation = kFar;
  for (int i = 0; i < feature.count; ++i) {
    const FeatureCorner& c = feature.corners[i];
    const double separation = height + dot(up, c.at());
    m.min_separation = std::min(m.min_separation, separation);
    if (separation > margin) continue;
    const Vec3 p = c.at() - (core_radius(a.g) + 0.5 * separation) * up;
    found[count++] = {p.x, p.y, p.z, separation, c.name};
  }
  m.normal = -up;
  reduce_patch(found, count, up, core_extent(a.g), m);
  for (int i = 0; i < m.count; ++i) m.points[i].position += a.T.position();
}

void collide_posed(const Posed& a, const Posed& b, double margin, PairCache& cache, Manifold& m) {
  const CorePair pair(a.g, b.g, relative_pose(a.T, b.T));
  if (a.g.kind == Kind::box && b.g.kind == Kind::box) {
    collide_boxes(pair, margin, cache, m);
  } else {
    collide_convex(pair, margin, cache, m);
  }
  m.rough = pair.rough;
  if (m.count == 0) return;
  m.normal = a.T.rotate(m.normal);
  for (int i = 0; i < m.count; ++i) m.points[i].position = a.T * m.points[i].position;
}

void collide_ordered(const Posed& a, const Posed& b, double margin, PairCache& cache, Manifold& m) {
  if (a.g.kind == Kind::sphere) {
    sphere_against(a.T.position(), a.g.radius, b, margin, 0, m);
  } else if (b.g.kind == Kind::half_space) {
    a.g.kind == Kind::box ? box_half_space(a, b, margin, m) : lowest_half_space(a, b, margin, m);
  } else if (a.g.kind == Kind::capsule && b.g.kind == Kind::capsule) {
    capsule_capsule(a, b, margin, m);
  } else {
    collide_posed(a, b, margin, cache, m);
  }
}

}  // namespace

void find_manifold(const Geometry& a, const SE3& T_a, const Geometry& b, const SE3& T_b,
                   double margin, PairCache& cache, Manifold& manifold) {
  manifold.count = 0;
  manifold.rough = false;
  manifold.min_separation = 0.0;
  if (a.kind <= b.kind) {
    collide_ordered({a, T_a}, {b, T_b}, margin, cache, manifold);
  } else {
    collide_ordered({b, T_b}, {a, T_a}, margin, cache, manifold);
    manifold.normal = -manifold.normal;
  }
}

void find_manifold(const Geometry& a, const SE3& T_a, const Geometry& b, const SE3& T_b,
                   double margin, Manifold& manifold) {
  PairCache cache;
  find_manifold(a, T_a, b, T_b, margin, cache, manifold);
}

}  // namespace vp::collide
