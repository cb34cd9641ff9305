#include "collide/distance.h"

#include <limits>

#include "collide/capsule_axes.h"
#include "collide/convex_contact.h"
#include "collide/epa.h"
#include "collide/polytope.h"

namespace vp::collide {
namespace {

// In the frame of a, between the surfaces.
ClosestPoints of_axis(const CorePair& pair, const BestAxis& axis) {
  const double ra = core_radius(pair.a), rb = core_radius(pair.b);
  return {axis.separation - ra - rb, axis.normal, axis.on_a + ra * axis.normal,
          axis.on_b - rb * axis.normal};
}

// The centre may be anywhere in b: deep points lose no accuracy.
ClosestPoints of_sphere(const CorePair& pair) {
  const Vec3 p = inverse_times(pair.T_a_b, Vec3{});
  const SignedDistance d = signed_distance(pair.b, p);
  const Vec3 n = -pair.T_a_b.rotate(d.normal);
  const Vec3 on_a = pair.a.radius * n;
  return {d.distance - pair.a.radius, n, on_a, on_a + (d.distance - pair.a.radius) * n};
}

ClosestPoints of_half_space(const CorePair& pair) {
  const Vec3 up = pair.T_a_b.rotation().cz;
  const double r = core_radius(pair.a);
  const Vec3 lowest = pair.support_a(-up) - r * up;
  const double height = dot(up, lowest - pair.T_a_b.position());
  return {height, -up, lowest, lowest - height * up};
}

ClosestPoints of_capsules(const CorePair& pair) {
  const Axis a{{}, {0, 0, 1}, pair.a.half.z};
  const Axis b{pair.T_a_b.position(), pair.T_a_b.rotation().cz, pair.b.half.z};
  const AxisPair nearest = nearest_on_axes(a, b);
  const Vec3 d = b.at(nearest.t) - a.at(nearest.s);
  return of_axis(pair, {norm(d), normal_between(a, b, d), a.at(nearest.s), b.at(nearest.t)});
}

BestAxis deepest_axis(const CorePair& pair, const Simplex& simplex, const PairCache& cache) {
  if (is_polytope(pair.a) && is_polytope(pair.b)) {
    FaceAxis face;
    EdgeAxis edge;
    find_overlap_axes(pair, 0.0, cache, face, edge);
    return edge.better ? edge.axis : axis_of_face(pair, face);
  }
  const Penetration p = epa(pair, simplex, std::numeric_limits<double>::infinity());
  return {-p.depth, p.normal, p.on_a, p.on_b};
}

ClosestPoints of_ordered(const CorePair& pair, PairCache& cache) {
  if (pair.b.kind == Kind::half_space) return of_half_space(pair);
  if (pair.a.kind == Kind::sphere) return of_sphere(pair);
  if (pair.a.kind == Kind::capsule && pair.b.kind == Kind::capsule) return of_capsules(pair);
  const GjkResult found =
      gjk(pair, first_direction(pair, cache), std::numeric_limits<double>::infinity());
  const BestAxis axis = found.state == GjkResult::State::separated
                            ? BestAxis{found.distance, found.normal, found.on_a, found.on_b}
                            : deepest_axis(pair, found.simplex, cache);
  remember(cache, axis.normal);
  return of_axis(pair, axis);
}

}  // namespace

ClosestPoints closest_points(const Geometry& a, const SE3& T_a, const Geometry& b, const SE3& T_b,
                             PairCache& cache) {
  const bool swapped = a.kind > b.kind;
  const SE3 &T_first = swapped ? T_b : T_a, &T_second = swapped ? T_a : T_b;
  const CorePair pair(swapped ? b : a, swapped ? a : b, relative_pose(T_first, T_second));
  ClosestPoints found = of_ordered(pair, cache);
  found.normal = T_first.rotate(found.normal);
  found.on_a = T_first * found.on_a;
  found.on_b = T_first * found.on_b;
  if (!swapped) return found;
  return {found.distance, -found.normal, found.on_b, found.on_a};
}

bool shapes_overlap(const Geometry& a, const SE3& T_a, const Geometry& b, const SE3& T_b,
                    PairCache& cache) {
  const bool swapped = a.kind > b.kind;
  const CorePair pair(swapped ? b : a, swapped ? a : b,
                      swapped ? relative_pose(T_b, T_a) : relative_pose(T_a, T_b));
  if (pair.b.kind == Kind::half_space) return of_half_space(pair).distance <= 0.0;
  if (pair.a.kind == Kind::sphere) return of_sphere(pair).distance <= 0.0;
  const double radii = core_radius(pair.a) + core_radius(pair.b);
  const GjkResult found = gjk(pair, first_direction(pair, cache), radii);
  if (found.state == GjkResult::State::overlaps) return true;
  remember(cache, found.normal);
  return found.state == GjkResult::State::separated && found.distance <= radii;
}

}  // namespace vp::collide
