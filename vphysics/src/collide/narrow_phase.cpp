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

// A sphere against any convex shape b. The normal points from a to b.
void sphere_against(const Posed& a, const Posed& b, const PairMargin& margin, Manifold& m) {
  const Vec3 centre = a.T.position();
  const double radius = a.shape.radius;
  const SignedDistance d = signed_distance(b.shape, inverse_times(b.T, centre));
  const double separation = d.distance - radius;
  m.min_separation = separation;
  m.normal = -b.T.rotate(d.normal);
  if (!margin.may_touch(separation, m.normal, a, b)) return;
  m.add(centre + (radius + 0.5 * separation) * m.normal, separation, 0);
}

Axis axis_of(const Posed& capsule) {
  return {capsule.T.position(), capsule.T.rotation().cz, capsule.shape.half.z};
}

// Parallel capsules touch along a segment: its two ends are the contact points.
void capsule_capsule(const Posed& a, const Posed& b, const PairMargin& margin, Manifold& m) {
  const Axis axis_a = axis_of(a), axis_b = axis_of(b);
  const Vec3 &da = axis_a.direction, &db = axis_b.direction;
  const AxisPair nearest = nearest_on_axes(axis_a, axis_b);
  const Vec3 d = axis_b.at(nearest.t) - axis_a.at(nearest.s);
  const double separation = norm(d) - a.shape.radius - b.shape.radius;
  m.min_separation = separation;
  m.normal = normal_between(axis_a, axis_b, d);
  if (!margin.may_touch(separation, m.normal, a, b)) return;
  constexpr double kAlongside = 1e-3;  // sine of the angle below which two points are used
  const double along = dot(da, db);
  if (norm(cross(da, db)) < kAlongside && a.shape.half.z > 0.0 && b.shape.half.z > 0.0) {
    const double centre = dot(da, b.T.position() - a.T.position());
    const double lower = std::max(-a.shape.half.z, centre - b.shape.half.z);
    const double upper = std::min(a.shape.half.z, centre + b.shape.half.z);
    if (upper > lower) {
      for (int i = 0; i < 2; ++i) {
        const double s = i == 0 ? lower : upper;
        const Vec3 pa = axis_a.at(s);
        const Vec3 pb =
            axis_b.at(std::clamp((s - centre) * along, -b.shape.half.z, b.shape.half.z));
        const double at_point = dot(m.normal, pb - pa) - a.shape.radius - b.shape.radius;
        if (at_point <= margin.largest()) {
          m.add(pa + (a.shape.radius + 0.5 * at_point) * m.normal, at_point,
                static_cast<std::uint32_t>(i + 1));
        }
      }
      return;
    }
  }
  m.add(axis_a.at(nearest.s) + (a.shape.radius + 0.5 * separation) * m.normal, separation, 0);
}

// The four corners of the face that faces the half-space most: the deepest corner is among them.
void box_half_space(const Posed& a, const Posed& b, const PairMargin& margin, Manifold& m) {
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
    p[axis] = n[axis] > 0.0 ? -a.shape.half[axis] : a.shape.half[axis];
    const int u = (axis + 1) % 3, v = (axis + 2) % 3;
    p[u] = corner & 1u ? a.shape.half[u] : -a.shape.half[u];
    p[v] = corner & 2u ? a.shape.half[v] : -a.shape.half[v];
    const Vec3 world = a.T * p;
    const double separation = dot(up, world - b.T.position());
    m.min_separation = std::min(m.min_separation, separation);
    const auto feature = static_cast<std::uint32_t>(8 * axis + (n[axis] > 0.0 ? 4 : 0)) + corner;
    if (separation <= margin.largest()) m.add(world - 0.5 * separation * up, separation, feature);
  }
  if (!margin.may_touch(m.min_separation, m.normal, a, b)) m.count = 0;
}

// The corners of the lowest feature.
void lowest_half_space(const Posed& a, const Posed& b, const PairMargin& margin, Manifold& m) {
  const Vec3 up = b.T.rotation().cz;
  const SE3 turned(a.T.rotation(), {});  // the position is added last, since it may be large
  const double height = dot(up, a.T.position() - b.T.position()) - core_radius(a.shape);
  Feature feature;
  find_feature(a.shape, turned, -a.T.unrotate(up), feature);
  PatchPoint found[kMaxCorners];
  int count = 0;
  m.min_separation = kFar;
  for (int i = 0; i < feature.count; ++i) {
    const FeatureCorner& c = feature.corners[i];
    const double separation = height + dot(up, c.at());
    m.min_separation = std::min(m.min_separation, separation);
    if (separation > margin.largest()) continue;
    const Vec3 p = c.at() - (core_radius(a.shape) + 0.5 * separation) * up;
    found[count++] = {p.x, p.y, p.z, separation, c.name};
  }
  m.normal = -up;
  if (!margin.may_touch(m.min_separation, m.normal, a, b)) return;
  reduce_patch(found, count, up, core_extent(a.shape), m);
  for (int i = 0; i < m.count; ++i) m.points[i].position += a.T.position();
}

void collide_posed(const Posed& a, const Posed& b, const PairMargin& margin_in_world,
                   PairCache& cache, Manifold& m) {
  const CorePair pair(a.shape, b.shape, relative_pose(a.T, b.T));
  const PairMargin margin = margin_in_world.in_frame(a.T);
  if (a.shape.kind == Kind::box && b.shape.kind == Kind::box) {
    collide_boxes(pair, margin, cache, m);
  } else {
    collide_convex(pair, margin, cache, m);
  }
  m.rough = pair.rough;
  m.normal = a.T.rotate(m.normal);
  for (int i = 0; i < m.count; ++i) m.points[i].position = a.T * m.points[i].position;
}

void collide_ordered(const Posed& a, const Posed& b, const PairMargin& margin, PairCache& cache,
                     Manifold& m) {
  if (a.shape.kind == Kind::sphere) {
    sphere_against(a, b, margin, m);
  } else if (b.shape.kind == Kind::half_space) {
    a.shape.kind == Kind::box ? box_half_space(a, b, margin, m)
                              : lowest_half_space(a, b, margin, m);
  } else if (a.shape.kind == Kind::capsule && b.shape.kind == Kind::capsule) {
    capsule_capsule(a, b, margin, m);
  } else {
    collide_posed(a, b, margin, cache, m);
  }
}

}  // namespace

void find_manifold(const Geometry& a, const SE3& T_a, const Geometry& b, const SE3& T_b,
                   const PairMargin& margin, PairCache& cache, Manifold& manifold) {
  manifold.count = 0;
  manifold.rough = false;
  manifold.min_separation = 0.0;
  manifold.normal = {};
  if (a.kind <= b.kind) {
    collide_ordered({a, T_a}, {b, T_b}, margin, cache, manifold);
  } else {
    collide_ordered({b, T_b}, {a, T_a}, margin.reversed(), cache, manifold);
    manifold.normal = -manifold.normal;
  }
}

void find_manifold(const Geometry& a, const SE3& T_a, const Geometry& b, const SE3& T_b,
                   const PairMargin& margin, Manifold& manifold) {
  PairCache cache;
  find_manifold(a, T_a, b, T_b, margin, cache, manifold);
}

}  // namespace vp::collide
