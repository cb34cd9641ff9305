// Closed-form ray casts: a convex shape is an intersection of simple sets, and the ray is inside
// each of them over one interval of distances.
//
// Sources: Ericson, Real-Time Collision Detection, 2005, section 5.3; Woop, Benthin, Wald,
// Watertight ray/triangle intersection, 2013.
#include "collide/ray.h"

#include <cmath>
#include <limits>
#include <utility>

#include "collide/compound_data.h"
#include "collide/surface.h"

namespace vp::collide {
namespace {

constexpr double kUnboundedRadius = std::numeric_limits<double>::infinity();

// The interval of distances inside a set, and the surface normal at its entry.
struct Stretch {
  double in = -kUnboundedRadius, out = kUnboundedRadius;
  Vec3 normal{0, 0, 1};

  bool empty() const { return !(in <= out); }
  void make_empty() { in = kUnboundedRadius, out = -kUnboundedRadius; }
  void enter(double t, const Vec3& n) {
    if (t > in) in = t, normal = n;
  }
  void leave(double t) { out = std::min(out, t); }
  // Intersects with the half-space n . x <= offset.
  void cut(const Ray& ray, const Vec3& n, double offset) {
    const double height = dot(n, ray.origin) - offset, along = dot(n, ray.direction);
    if (along < 0.0) {
      enter(-height / along, n);
    } else if (along > 0.0) {
      leave(-height / along);
    } else if (height > 0.0) {
      make_empty();
    }
  }
  void cut_slab(const Ray& ray, int axis, double half) {
    Vec3 n;
    n[axis] = 1.0;
    cut(ray, n, half);
    cut(ray, -n, half);
  }
};

Stretch in_sphere(const Ray& ray, const Vec3& centre, double radius) {
  Stretch s;
  const Vec3 o = ray.origin - centre, beside = cross(o, ray.direction);
  const double nearest = -dot(o, ray.direction);
  const double square = radius * radius - dot(beside, beside);
  if (square < 0.0) return s.make_empty(), s;
  const double half = std::sqrt(square);
  const Vec3 out = o + (nearest - half) * ray.direction;
  const double length = norm(out);
  s.enter(nearest - half, length > 0.0 ? (1.0 / length) * out : -ray.direction);
  s.leave(nearest + half);
  return s;
}

// Intersects with the infinite cylinder of this radius about the z axis.
void cut_tube(Stretch& s, const Ray& ray, double radius) {
  const Vec3 &o = ray.origin, &d = ray.direction;
  const double a = d.x * d.x + d.y * d.y;
  if (a == 0.0) {
    if (o.x * o.x + o.y * o.y > radius * radius) s.make_empty();
    return;
  }
  const double beside = o.x * d.y - o.y * d.x;
  const double square = radius * radius * a - beside * beside;
  if (square < 0.0) return s.make_empty();
  const double nearest = -(o.x * d.x + o.y * d.y) / a, half = std::sqrt(square) / a;
  const double in = nearest - half;
  s.enter(in, (1.0 / radius) * Vec3{o.x + in * d.x, o.y + in * d.y, 0.0});
  s.leave(nearest + half);
}

Stretch in_cylinder(const Ray& ray, double radius, double half) {
  Stretch s;
  s.cut_slab(ray, 2, half);
  cut_tube(s, ray, radius);
  return s;
}

// Intersects with the nappe |(x, y)| <= k u, u = half - z >= 0, where A t^2 + 2 B t + C <= 0.
void cut_nappe(Stretch& s, const Ray& ray, double k, double half) {
  const Vec3 &o = ray.origin, &d = ray.direction;
  const double u = half - o.z, du = -d.z;
  const double A = d.x * d.x + d.y * d.y - k * k * du * du;
  const double B = o.x * d.x + o.y * d.y - k * k * u * du;
  const double C = o.x * o.x + o.y * o.y - k * k * u * u;
  const auto enter = [&](double t) {
    const double along = k * k * (u + t * du);
    const Vec3 n{o.x + t * d.x, o.y + t * d.y, along};
    const double length = norm(n);
    s.enter(t, length > 0.0 ? (1.0 / length) * n : Vec3{0, 0, 1});
  };
  const double square = B * B - A * C;
  if (square < 0.0) {
    // A steep line is never outside both nappes, except by rounding, and then it passes through the
    // apex.
    if (A < 0.0) return;
    return s.make_empty();
  }
  const double q = -(B + std::copysign(std::sqrt(square), B));
  if (q == 0.0) {  // A = 0 along the side, or through the apex
    if (C > 0.0) s.make_empty();
    return;
  }
  const double one = q / A, other = C / q;  // one is infinite if A is zero
  if (A > 0.0) {
    enter(std::min(one, other));
    s.leave(std::max(one, other));
  } else if (A < 0.0) {  // from one nappe to the other: u is positive in this one
    if (du > 0.0) {
      enter(std::max(one, other));
    } else {
      s.leave(std::min(one, other));
    }
  } else if (B < 0.0) {
    enter(other);
  } else {
    s.leave(other);
  }
}

Stretch in_cone(const Ray& ray, double radius, double half) {
  Stretch s;
  s.cut(ray, {0, 0, -1}, half);
  s.cut(ray, {0, 0, 1}, half);
  cut_nappe(s, ray, radius / (2.0 * half), half);
  return s;
}

// The union with a piece of a capsule; the pieces together are convex.
void join(Stretch& s, const Stretch& piece) {
  if (piece.empty()) return;
  if (s.empty() || piece.in < s.in) {
    s.in = piece.in;
    s.normal = piece.normal;
  }
  s.out = std::max(s.out, piece.out);
}

Stretch in_capsule(const Ray& ray, double radius, double half) {
  Stretch s;
  s.make_empty();
  join(s, in_sphere(ray, {0, 0, half}, radius));
  join(s, in_sphere(ray, {0, 0, -half}, radius));
  join(s, in_cylinder(ray, radius, half));
  return s;
}

Stretch in_hull(const Ray& ray, const HullData& hull) {
  Stretch s;
  for (const ConvexHull::Face& face : hull.faces) {
    s.cut(ray, face.normal, face.offset);
    if (s.empty()) break;
  }
  return s;
}

Stretch in_convex(const Geometry& g, const Ray& ray) {
  Stretch s;
  switch (g.kind) {
    case Kind::sphere:
      return in_sphere(ray, {}, g.radius);
    case Kind::capsule:
      return in_capsule(ray, g.radius, g.half.z);
    case Kind::box:
      for (int axis = 0; axis < 3; ++axis) s.cut_slab(ray, axis, g.half[axis]);
      return s;
    case Kind::cylinder:
      return in_cylinder(ray, g.radius, g.half.z);
    case Kind::cone:
      return in_cone(ray, g.radius, g.half.z);
    case Kind::hull:
      return in_hull(ray, *g.hull);
    case Kind::half_space:
    case Kind::triangle:
    case Kind::mesh:
    case Kind::height_field:
    case Kind::compound:
      break;
  }
  s.cut(ray, {0, 0, 1}, 0.0);
  return s;
}

// Uses the point of the ray closest to the shape's origin as its origin: squares of large distances
// would lose precision.
bool cast_at_convex(const Geometry& g, const Ray& ray, double limit, RayEntry& entry) {
  const bool is_bounded = g.kind != Kind::half_space;
  const double ahead = is_bounded ? -dot(ray.origin, ray.direction) : 0.0;
  const Stretch s = in_convex(g, {ray.origin + ahead * ray.direction, ray.direction});
  if (s.empty() || s.out < -ahead || s.in > limit - ahead) return false;
  if (s.in + ahead > 0.0) {
    entry = {s.in + ahead, s.normal, 0};
  } else {
    entry = {0.0, signed_distance(g, ray.origin).normal, 0};
  }
  return true;
}

// Corners are sheared so that the ray is along one axis, at the origin of the plane perpendicular
// to it. Two products decide on which side of an edge the origin is; rounding never reverses their
// order. A corner has the same coordinates in all its triangles. So no ray passes between
// triangles.
class RayFrame {
 public:
  explicit RayFrame(const Ray& ray) : origin_(ray.origin) {
    const Vec3& d = ray.direction;
    for (int i = 1; i < 3; ++i) {
      if (std::fabs(d[i]) > std::fabs(d[z_])) z_ = i;
    }
    x_ = (z_ + 1) % 3;
    y_ = (z_ + 2) % 3;
    if (d[z_] < 0.0) std::swap(x_, y_);  // keeps the orientation of the triangles
    along_ = d[z_];
    shear_x_ = d[x_] / along_;
    shear_y_ = d[y_] / along_;
  }
  // A triangle's front is counter-clockwise as seen from the ray's origin.
  bool overlaps(const SurfaceTriangle& t, bool two_sided, double& distance) const {
    const Corner a = seen(t.p[0]), b = seen(t.p[1]), c = seen(t.p[2]);
    const double u = c.x * b.y - c.y * b.x, v = a.x * c.y - a.y * c.x, w = b.x * a.y - b.y * a.x;
    const bool front = u >= 0.0 && v >= 0.0 && w >= 0.0, back = u <= 0.0 && v <= 0.0 && w <= 0.0;
    const double sum = u + v + w;
    if (sum == 0.0 || !(front || (back && two_sided))) return false;
    distance = ((u / sum) * a.z + (v / sum) * b.z + (w / sum) * c.z) / along_;
    return true;
  }

 private:
  struct Corner {
    double x, y, z;
  };
  Corner seen(const Vec3& p) const {
    const Vec3 a = p - origin_;
    return {a[x_] - shear_x_ * a[z_], a[y_] - shear_y_ * a[z_], a[z_]};
  }

  Vec3 origin_;
  int x_ = 0, y_ = 0, z_ = 0;
  double along_, shear_x_, shear_y_;
};

// Order by distance, then by part, independent of the order of discovery.
bool is_first(const RayEntry& best, double distance, std::uint32_t part) {
  return distance < best.distance || (distance == best.distance && part < best.part);
}

bool cast_at_surface(const Surface& surface, const Ray& ray, double limit, CastScratch& scratch,
                     RayEntry& entry) {
  RayEntry best{kUnboundedRadius, {}, 0};
  const RayFrame frame(ray);
  const auto hit = [&](std::uint32_t id, double) {
    const SurfaceTriangle t = surface.triangle(id);
    double distance = 0.0;
    if (frame.overlaps(t, surface.two_sided(), distance) && distance >= 0.0 && distance <= limit &&
        is_first(best, distance, id)) {
      const bool from_behind = dot(t.normal, ray.direction) > 0.0;
      best = {distance, from_behind ? -t.normal : t.normal, id};
    }
    return limit > 0.0 ? std::min(1.0, best.distance / limit) : 1.0;
  };
  surface.cast({{ray.origin, ray.origin}, limit * ray.direction}, 1.0, scratch, hit);
  if (best.distance == kUnboundedRadius) return false;
  entry = best;
  return true;
}

bool cast_at_compound(const CompoundData& compound, const Ray& ray, double limit,
                      CastScratch& scratch, RayEntry& entry) {
  RayEntry best{kUnboundedRadius, {}, 0};
  const auto hit = [&](std::uint32_t i, float) {
    const SE3& T = compound.parts[i].T_compound_part;
    RayEntry found{};
    if (cast_at_convex(compound.geometries[i],
                       {inverse_times(T, ray.origin), T.unrotate(ray.direction)}, limit, found) &&
        is_first(best, found.distance, i)) {
      best = {found.distance, T.rotate(found.normal), i};
    }
    return limit > 0.0 ? std::min(1.0, best.distance / limit) : 1.0;
  };
  compound.tree.cast({{ray.origin, ray.origin}, limit * ray.direction}, 1.0, scratch, hit);
  if (best.distance == kUnboundedRadius) return false;
  entry = best;
  return true;
}

}  // namespace

bool cast_ray(const Geometry& g, const Ray& ray, double limit, CastScratch& scratch,
              RayEntry& entry) {
  if (g.kind == Kind::compound) return cast_at_compound(*g.compound, ray, limit, scratch, entry);
  if (is_surface(g)) return cast_at_surface(surface_of(g), ray, limit, scratch, entry);
  return cast_at_convex(g, ray, limit, entry);
}

}  // namespace vp::collide
