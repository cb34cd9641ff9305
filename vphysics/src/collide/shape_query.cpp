#include "collide/shape_query.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "collide/compound_data.h"
#include "collide/surface.h"

namespace vp::collide {
namespace {

// Calls f(part, its pose, its number) for a compound's parts, or for the shape itself.
template <class F>
void for_parts(const Geometry& g, const SE3& T, const F& f) {
  if (g.kind != Kind::compound) return f(g, T, 0u);
  for (std::uint32_t i = 0; i < g.compound->parts.size(); ++i) {
    f(g.compound->geometries[i], T * g.compound->parts[i].T_compound_part, i);
  }
}

// --- overlap -------------------------------------------------------------------------------------

bool part_touches(const Geometry& a, const SE3& T_a, const Geometry& b, const SE3& T_b,
                  PartsScratch& scratch) {
  PairCache fresh;
  if (b.kind == Kind::compound) {
    bool touches = false;
    const Bounds box = bounds_of(a, relative_pose(T_b, T_a));
    b.compound->tree.overlapping(rounded_outward(box), [&](std::uint32_t i) {
      if (touches) return;
      fresh = {};
      touches = shapes_overlap(a, T_a, b.compound->geometries[i],
                               T_b * b.compound->parts[i].T_compound_part, fresh);
    });
    return touches;
  }
  if (!is_surface(b)) return shapes_overlap(a, T_a, b, T_b, fresh);
  const SE3 T = relative_pose(T_b, T_a);
  const Surface surface = surface_of(b);
  scratch.triangles.clear();
  surface.append_overlapping(bounds_of(a, T), scratch.triangles);
  return std::any_of(scratch.triangles.begin(), scratch.triangles.end(), [&](std::uint32_t id) {
    const SurfaceTriangle t = surface.triangle(id);
    fresh = {};
    return shapes_overlap(a, T, triangle_geometry(t.p), SE3{}, fresh);
  });
}

// --- closest parts -------------------------------------------------------------------------------

class NearestFinder {
 public:
  NearestFinder(double limit, PartsScratch& scratch, NearestParts& best)
      : limit_(limit), scratch_(scratch), best_(best) {}

  bool found() const { return found_; }

  void find(const Geometry& a, const SE3& T_a, std::uint32_t part_a, const Geometry& b,
            const SE3& T_b) {
    if (b.kind == Kind::compound) {
      const Bounds box = bounds_of(a, relative_pose(T_b, T_a));
      b.compound->tree.nearest(box, {1.0, 1.0, 1.0}, limit_, scratch_.cast,
                               [&](std::uint32_t i, float) {
                                 const SE3 T = T_b * b.compound->parts[i].T_compound_part;
                                 return consider(a, T_a, part_a, b.compound->geometries[i], T, i);
                               });
    } else if (is_surface(b)) {
      find_on_surface(a, T_a, part_a, b, T_b);
    } else {
      consider(a, T_a, part_a, b, T_b, 0);
    }
  }

 private:
  void find_on_surface(const Geometry& a, const SE3& T_a, std::uint32_t part_a, const Geometry& b,
                       const SE3& T_b) {
    const SE3 T = relative_pose(T_b, T_a);
    const Surface surface = surface_of(b);
    const Bounds box = bounds_of(a, T);
    surface.nearest(box, limit_, scratch_.cast, [&](std::uint32_t id) {
      const SurfaceTriangle t = surface.triangle(id);
      const Geometry triangle = triangle_geometry(t.p);
      const FloatBounds around = rounded_outward(bounds_of(triangle, SE3{}));
      if (static_cast<double>(distance_between(box, around, {1.0, 1.0, 1.0})) > limit_) {
        return limit_;
      }
      return consider(a, T_a, part_a, triangle, T_b, id);
    });
  }

  double consider(const Geometry& a, const SE3& T_a, std::uint32_t part_a, const Geometry& b,
                  const SE3& T_b, std::uint32_t part_b) {
    PairCache fresh;
    const ClosestPoints points = closest_points(a, T_a, b, T_b, fresh);
    const double best = found_ ? best_.points.distance : limit_;
    const bool first =
        found_ ? part_a < best_.part_a || (part_a == best_.part_a && part_b < best_.part_b) : true;
    if (points.distance < best || (points.distance == best && first)) {
      best_ = {points, part_a, part_b};
      found_ = true;
      limit_ = std::min(limit_, std::max(0.0, points.distance));
    }
    return limit_;
  }

  double limit_;
  PartsScratch& scratch_;
  NearestParts& best_;
  bool found_ = false;
};

// --- first impact --------------------------------------------------------------------------------

// An upper bound of the distance of the shape's points from its centre of rotation.
double bounding_radius_of(const MovingShape& m) {
  return norm(m.T * core_centre(*m.shape) - m.motion.x) + core_extent(*m.shape) +
         core_radius(*m.shape);
}
// An upper bound of the displacement of a point within `radius` by rotation.
double rotation_bound(const MovingShape& m, double radius, double duration) {
  return std::min(norm(m.motion.w) * duration, 2.0) * radius;
}

// Upper bound of the distance of a point that rotates by `angle` about a centre within `radius`
// from the chord of its path, at the same time: half of the squared angle over four, or the
// diameter.
double arc_height(double radius, double angle) {
  return radius * std::min(0.125 * angle * angle, 2.0);
}

// The volume that the first shape sweeps, in the second's frame: bounds that move as their centre
// does from start to end, enlarged as far as they grow and the paths deviate from their chords.
Sweep sweep_of(const ImpactQuery& q, double more) {
  MovingShape a = q.a;
  a.motion.v -= q.b.motion.v;
  const Bounds start = bounds_of(*a.shape, relative_pose(q.b.T, a.T)),
               end = bounds_of(*a.shape, relative_pose(q.b.T, pose_at(a, q.duration)));
  const Vec3 displacement = 0.5 * (end.lower + end.upper - start.lower - start.upper);
  const Vec3 growth = 0.5 * (end.upper - end.lower - start.upper + start.lower);
  const double radius = bounding_radius_of(a);
  const double far = norm(a.motion.x - q.b.motion.x) + norm(q.duration * a.motion.v) + radius;
  const Bounds all = grown(start, more + arc_height(radius, norm(a.motion.w) * q.duration) +
                                      rotation_bound(q.b, far, q.duration));
  const Vec3 side{std::max(growth.x, 0.0), std::max(growth.y, 0.0), std::max(growth.z, 0.0)};
  return {{all.lower - side, all.upper + side}, displacement};
}

class ImpactFinder {
 public:
  ImpactFinder(double target, double tolerance, NearParts near_at_start, PartsScratch& scratch,
               PartsImpact& best)
      : target_(target),
        within_(std::max(0.0, target) + tolerance),
        passes_near_(near_at_start == NearParts::passed),
        scratch_(scratch),
        best_(best) {
    best_.time = std::numeric_limits<double>::infinity();
  }
  bool found() const { return best_.time < std::numeric_limits<double>::infinity(); }

  // Precondition: a is convex.
  void find(const ImpactQuery& q, std::uint32_t part_a) {
    const Geometry& b = *q.b.shape;
    if (b.kind == Kind::compound) {
      b.compound->tree.cast(sweep_of(q, within_), limit(q.duration), scratch_.cast,
                            [&](std::uint32_t i, float) {
                              ImpactQuery part = q;
                              part.b.shape = &b.compound->geometries[i];
                              part.b.T = q.b.T * b.compound->parts[i].T_compound_part;
                              consider(part, part_a, i);
                              return limit(q.duration);
                            });
    } else if (is_surface(b)) {
      const Surface surface = surface_of(b);
      surface.cast(sweep_of(q, within_), limit(q.duration), scratch_.cast,
                   [&](std::uint32_t id, double) {
                     const SurfaceTriangle t = surface.triangle(id);
                     const Geometry triangle = triangle_geometry(t.p);
                     ImpactQuery part = q;
                     part.b.shape = &triangle;
                     consider(part, part_a, id, surface.two_sided() ? nullptr : &t);
                     return limit(q.duration);
                   });
    } else {
      consider(q, part_a, 0);
    }
  }

 private:
  // The fraction of the sweep after which no impact is of interest.
  double limit(double duration) const {
    return duration > 0.0 ? std::min(1.0, best_.time / duration) : 1.0;
  }

  void consider(const ImpactQuery& q, std::uint32_t part_a, std::uint32_t part_b,
                const SurfaceTriangle* one_sided = nullptr) {
    PairCache cache;
    const double t = time_of_impact(q, target_, cache, best_.time);
    if (t < 0.0 || t > best_.time || (t == 0.0 && passes_near_)) return;
    const bool first = part_a < best_.part_a || (part_a == best_.part_a && part_b < best_.part_b);
    if (t == best_.time && !first) return;
    if (one_sided != nullptr) {
      const Vec3 centre = pose_at(q.a, t) * core_centre(*q.a.shape);
      const Vec3 local = inverse_times(pose_at(q.b, t), centre);
      if (dot(one_sided->normal, local - one_sided->p[0]) < 0.0) return;
    }
    best_ = {t, closest_points(*q.a.shape, pose_at(q.a, t), *q.b.shape, pose_at(q.b, t), cache),
             part_a, part_b};
  }

  double target_, within_;
  bool passes_near_;
  PartsScratch& scratch_;
  PartsImpact& best_;
};

}  // namespace

bool parts_touch(const Geometry& a, const SE3& T_a, const Geometry& b, const SE3& T_b,
                 PartsScratch& scratch) {
  bool touches = false;
  for_parts(a, T_a, [&](const Geometry& part, const SE3& T, std::uint32_t) {
    touches = touches || part_touches(part, T, b, T_b, scratch);
  });
  return touches;
}

bool nearest_parts(const Geometry& a, const SE3& T_a, const Geometry& b, const SE3& T_b,
                   double limit, PartsScratch& scratch, NearestParts& found) {
  NearestFinder finder(limit, scratch, found);
  for_parts(a, T_a, [&](const Geometry& part, const SE3& T, std::uint32_t i) {
    finder.find(part, T, i, b, T_b);
  });
  return finder.found();
}

bool first_impact(const ImpactQuery& query, double target, PartsScratch& scratch,
                  PartsImpact& found, NearParts near_at_start) {
  ImpactFinder finder(target, query.tolerance, near_at_start, scratch, found);
  for_parts(*query.a.shape, query.a.T, [&](const Geometry& part, const SE3& T, std::uint32_t i) {
    ImpactQuery q = query;
    q.a.shape = &part;
    q.a.T = T;
    finder.find(q, i);
  });
  return finder.found();
}

}  // namespace vp::collide
