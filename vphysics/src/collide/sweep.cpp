// Conservative advancement of second order.
//
// Let c(t) be the sphere's centre in the frame of the other shape, and f = d(c) - r - target. The
// signed distance d is convex, so with its gradient n at c(t)
//     d(c(t+s)) >= d(c(t)) + n . (c(t+s) - c(t))
// and with |c''| <= A on the whole interval
//     f(t+s)    >= f + f' s - A s^2 / 2,        f' = n . c'(t).
// The smallest positive root of the right side is a step that cannot pass the impact. Unlike a
// bound on speed alone this needs no more steps for a grazing ball, nor for a man who turns at 150
// rad/s.
//
// A: with u = v_sphere - v_other - w x d (d from x of the other body to the centre),
// c' = R^T u and c'' = R^T (u' - w x u), |u'| <= |w_s|^2 rho + |w| |v_rel|, where rho is the
// centre's distance from the point its own body turns about. Sources: Mirtich 1996, section 2.3
// (advancement); the second-order bound is derived here.
#include "collide/sweep.h"

#include <cmath>
#include <limits>

namespace vp::collide {
namespace {

constexpr int kMaxAdvances = 64;

bool turns(const Vec3& w) {
  return w.x != 0.0 || w.y != 0.0 || w.z != 0.0;
}

struct Local {
  Vec3 centre;    // in the frame of the shape
  Vec3 velocity;  // the same frame
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
  const double reach = norm(q.centre - q.other.x) + v * q.duration;
  return ws * ws * rho + w * (2.0 * v + w * reach);
}

// Smallest positive s with f + df s - A s^2 / 2 = 0, f > 0.
double safe_step(double f, double df, double A) {
  const double root = std::sqrt(df * df + 2.0 * A * f);
  if (df < 0.0) return 2.0 * f / (root - df);
  return A > 0.0 ? (df + root) / A : std::numeric_limits<double>::infinity();
}

}  // namespace

double separation_at(const SweepQuery& query, double time) {
  return signed_distance(*query.shape, local_at(query, time).centre).distance - query.radius;
}

double time_of_impact(const SweepQuery& q, double target) {
  const double A = acceleration_bound(q);
  double t = 0.0;
  for (int i = 0; i < kMaxAdvances; ++i) {
    const Local c = local_at(q, t);
    const SignedDistance d = signed_distance(*q.shape, c.centre);
    const double f = d.distance - q.radius - target;
    if (f <= q.tolerance) return t;
    t += safe_step(f, dot(d.normal, c.velocity), A);
    if (!(t < q.duration)) return -1.0;
  }
  return t;  // not there yet, but safe: the caller advances to t and asks again
}

}  // namespace vp::collide
