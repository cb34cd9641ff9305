#include "world/free_rotation.h"

#include <algorithm>
#include <cmath>

namespace vp {
namespace {

// Maximum rotation of a part [rad]: two or three steps of Newton's method, and a nutation within
// 2%.
constexpr double kPart = 0.5;
// Maximum number of parts: beyond 128 rad in a step the orientation is meaningless.
constexpr int kMaxParts = 256;

// tan(x) / x for |x| <= kPart / 2: continued fraction to x^9, exact to rounding.
double half_tangent_ratio(double xx) {
  return (945.0 - xx * (105.0 - xx)) / (945.0 - xx * (420.0 - 15.0 * xx));
}

// Solves  I (m - w) + b m x I m = 0  for m.
Vec3 midpoint(const Sym3& I, const Vec3& w, double b) {
  constexpr double kEnough = 1e-12;  // relative to w
  constexpr int kMax = 8;
  const Mat3 inertia{I * Vec3{1, 0, 0}, I * Vec3{0, 1, 0}, I * Vec3{0, 0, 1}};
  const double enough = kEnough * kEnough * dot(w, w);
  Vec3 m = w;
  for (int i = 0; i < kMax; ++i) {
    const Vec3 L = I * m;
    const Mat3 J = inertia + b * (skew(m) * inertia - skew(L));
    const double determinant = dot(J.cx, cross(J.cy, J.cz));
    if (!(std::fabs(determinant) > 0.0)) break;
    const Vec3 f = I * (w - m) + b * cross(L, m);
    const double scale = 1.0 / determinant;
    const Vec3 step{scale * dot(f, cross(J.cy, J.cz)), scale * dot(J.cx, cross(f, J.cz)),
                    scale * dot(J.cx, cross(J.cy, f))};
    m += step;
    // The residual is  b step x I step.
    const double left = b * dot(step, step);
    if (left * left <= enough) break;
  }
  return m;
}

// v in a frame that has rotated by Cayley's map of c.
Vec3 rotated_back(const Vec3& c, const Vec3& v) {
  const Vec3 u = cross(v, c);
  return v + (2.0 / (1.0 + dot(c, c))) * (u + cross(u, c));
}

}  // namespace

FreeRotation free_rotation(const Sym3& I, const Sym3& inverse, const Vec3& start, double dt) {
  FreeRotation out{{0, 0, 0, 1}, start};
  Vec3 L = I * start;
  double left = dt;
  for (int i = 0; i < kMaxParts && left > 0.0; ++i) {
    const Vec3 w = out.w;
    const double ww = dot(w, w);
    if (i == 0 && hardly_rotates(w, dt)) {
      const Vec3 c = (0.5 * dt) * w;
      const double shrink = 1.0 - 0.5 * dot(c, c);
      out.q = {shrink * c.x, shrink * c.y, shrink * c.z, shrink};
      out.w = inverse * rotated_back(c, L);
      return out;
    }
    if (!(ww > 0.0)) break;
    // With an inertia that no matter can have, w may change faster than the body rotates.
    const Vec3 change = inverse * cross(L, w);
    const double fastest = std::sqrt(std::max(ww, dot(change, change) / ww));
    const double s = left * fastest > kPart ? kPart / fastest : left;
    const double b = 0.5 * s * half_tangent_ratio(0.25 * s * s * ww);
    const Vec3 m = midpoint(I, w, b), c = b * m;
    const Quaternion q = out.q;
    const Vec3 v{q.x, q.y, q.z}, next = q.w * c + v + cross(v, c);
    const double shrink = 1.0 / std::sqrt(1.0 + dot(c, c));
    out.q = {shrink * next.x, shrink * next.y, shrink * next.z, shrink * (q.w - dot(v, c))};
    L = rotated_back(c, L);
    out.w = inverse * L;
    out.rotation_sum += s * m;
    left -= s;
  }
  return out;
}

Vec3 mean_rotation(const FreeRotation& rotation) {
  const Vec3 shorter = Log(rotation.q);
  const double angle = norm(shorter), rotation_sum = norm(rotation.rotation_sum);
  if (rotation_sum <= kPi) return shorter;
  // Adds the number of whole revolutions, of either sign, that comes closest to the rotation sum.
  const Vec3 axis =
      angle > 1e-9 ? (1.0 / angle) * shorter : (1.0 / rotation_sum) * rotation.rotation_sum;
  const double revolutions =
      std::floor((dot(axis, rotation.rotation_sum) - angle) / (2.0 * kPi) + 0.5);
  return (angle + 2.0 * kPi * revolutions) * axis;
}

}  // namespace vp
