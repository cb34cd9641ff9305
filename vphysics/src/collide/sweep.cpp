// Conservative advancement of second order.
//
// Let c(t) be the sphere's centre in the frame of the other shape, and f = d(c) - r - target. The
// signed distance d is convex, so with its gradient n at c(t)
//     d(c(t+s)) >= d(c(t)) + n . (c(t+s) - c(t))
// and with |c''| <= A on the whole interval
//     f(t+s)    >= f + f' s - A s^2 / 2,        f' = n . c'(t).
// The smallest positive root of the right side is a step that cannot pass the impact. Unlike a
// bound on the speed alone it needs no extra steps for a grazing ball, nor for a body that rotates
// at 150 rad/s.
//
// A: with u = v_sphere - v_other - w x d (d from x of the other body to the centre), c' = R^T u and
// c'' = R^T (u' - w x u), |u'| <= |w_s|^2 rho + |w| |v_rel|, where rho is the centre's distance
// from its own body's centre of rotation. Sources: Mirtich 1996, section 2.3 (advancement); the
// second-order bound is derived here.
#include "collide/sweep.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "collide/compound_data.h"
#include "collide/triangle_contact.h"

namespace vp::collide {
namespace {

constexpr int kMaxSphereAdvances = 64;

bool turns(const Vec3& w) {
  return w.x != 0.0 || w.y != 0.0 || w.z != 0.0;
}

struct Local {
  Vec3 centre;    // in the frame of the shape
  Vec3 velocity;  // in the frame of the shape
};

Local local_at(const SweepQuery& q, double t) {
  Vec3 arm = q.centre - q.sphere.x;
  if (turns(q.sphere.w) && dot(arm, arm) > 0.0) arm = Exp(t * q.sphere.w) * arm;
  const Vec3 centre = q.sphere.x + t * q.sphere.v + arm;
  Vec3 d = centre - (q.other.x + t * q.other.v);
  Vec3 u = q.sphere.v + cross(q.sphere.w, arm) - q.other.v - cross(q.other.w, d);
  if (turns(q.other.w)) {
    const Mat3 R = Exp(t * q.other.w).matrix();
    d = transposed_times(R, d);
    u = transposed_times(R, u);
  }
  return {inverse_times(q.T_shape, q.other.x + d), q.T_shape.unrotate(u)};
}

double acceleration_bound(const SweepQuery& q) {
  const double rho = norm(q.centre - q.sphere.x);
  const double ws = norm(q.sphere.w), w = norm(q.other.w);
  const double v = norm(q.sphere.v - q.other.v) + ws * rho;
  const double distance_bound = norm(q.centre - q.other.x) + v * q.duration;
  return ws * ws * rho + w * (2.0 * v + w * distance_bound);
}

// The smallest positive s with f + df s - A s^2 / 2 = 0, f > 0.
double safe_step(double f, double df, double A) {
  const double root = std::sqrt(df * df + 2.0 * A * f);
  if (df < 0.0) return 2.0 * f / (root - df);
  return A > 0.0 ? (df + root) / A : std::numeric_limits<double>::infinity();
}

// The first time at which distance(centre in the shape's frame) has decreased to target plus
// radius. distance is a convex function, like signed_distance.
template <class F>
double first_time(const SweepQuery& q, double A, double target, const F& distance) {
  double t = 0.0;
  for (int i = 0; i < kMaxSphereAdvances; ++i) {
    const Local c = local_at(q, t);
    const SignedDistance d = distance(c.centre);
    const double f = d.distance - q.radius - target;
    if (f <= q.tolerance) return t;
    t += safe_step(f, dot(d.normal, c.velocity), A);
    if (!(t < q.duration)) return -1.0;
  }
  return t;  // not reached, but safe: the caller advances to t and repeats the query
}

double earlier(double a, double b) {
  return a < 0.0 || b < 0.0 ? std::max(a, b) : std::min(a, b);
}

// Bounds of all positions of the sphere, in the shape's frame: its centre deviates from the chord
// by at most A h^2 / 8.
Bounds bounds_of_sweep(const SweepQuery& q, double A, double target) {
  const Vec3 from = local_at(q, 0.0).centre, to = local_at(q, q.duration).centre;
  const double around = q.radius + std::max(target, 0.0) + q.tolerance;
  return grown(merged({from, from}, {to, to}), around + 0.125 * A * q.duration * q.duration);
}

double time_to_parts(const SweepQuery& q, double A, double target) {
  const CompoundData& compound = *q.shape->compound;
  double first = -1.0;
  const auto update_if_remote = [&](std::uint32_t i) {
    SweepQuery part = q;
    part.shape = &compound.geometries[i];
    part.T_shape = q.T_shape * compound.parts[i].T_compound_part;
    first = earlier(first, time_of_impact(part, target));
  };
  compound.tree.overlapping(rounded_outward(bounds_of_sweep(q, A, target)), update_if_remote);
  return first;
}

SignedDistance distance_to_segment(const Vec3& a, const Vec3& b, const Vec3& p) {
  const Vec3 ab = b - a;
  const Vec3 offset = p - a - std::clamp(dot(p - a, ab) / dot(ab, ab), 0.0, 1.0) * ab;
  const double d = norm(offset);
  return {d, d > 0.0 ? (1.0 / d) * offset : Vec3{0, 0, 1}};
}

// A triangle's face is hit when its plane is, an active edge when its segment is, if that part is
// then the active one of the triangle. Neighbours, which are hit no later, cover the rest.
double time_to_triangle(const SweepQuery& q, double A, double target, const Surface& surface,
                        const SurfaceTriangle& t) {
  const auto active = [&](double time) {
    if (time < 0.0) return time;
    const double distance = active_distance(surface, t, local_at(q, time).centre);
    return distance - q.radius - target <= 1.01 * q.tolerance ? time : -1.0;
  };
  double first = active(first_time(q, A, target, [&](const Vec3& p) {
    return SignedDistance{dot(t.normal, p - t.p[0]), t.normal};
  }));
  for (int e = 0; e < 3; ++e) {
    if (!is_active_edge(t, e)) continue;
    const double time = first_time(q, A, target, [&](const Vec3& p) {
      return distance_to_segment(t.p[e], t.p[(e + 1) % 3], p);
    });
    first = earlier(first, active(time));
  }
  return first;
}

double time_to_surface(const SweepQuery& q, double A, double target) {
  const Surface surface = surface_of(*q.shape);
  const Vec3 from = local_at(q, 0.0).centre;
  double first = -1.0;
  surface.overlapping(bounds_of_sweep(q, A, target), [&](std::uint32_t id) {
    SurfaceTriangle t = surface.triangle(id);
    if (!face_towards(t, from, surface.two_sided())) return;
    first = earlier(first, time_to_triangle(q, A, target, surface, t));
  });
  return first;
}

}  // namespace

double separation_at(const SweepQuery& query, double time) {
  return signed_distance(*query.shape, local_at(query, time).centre).distance - query.radius;
}

double time_of_impact(const SweepQuery& q, double target) {
  const double A = acceleration_bound(q);
  if (is_surface(*q.shape)) return time_to_surface(q, A, target);
  if (q.shape->kind == Kind::compound) return time_to_parts(q, A, target);
  return first_time(q, A, target, [&](const Vec3& p) { return signed_distance(*q.shape, p); });
}

}  // namespace vp::collide
