#include "collide/impact_manifold.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "collide/time_of_impact.h"

namespace vp::collide {
namespace {

constexpr int kMaxRefinements = 6;
// In tolerances: what a resting contact may close in a step; the depth at which the impact is
// reached; the depth at which the extrapolation is no use; the depth that it may have now.
constexpr double kResting = 0.1, kReached = 0.9, kTooDeep = 4.0, kStartDepth = 0.3;
// Factor of the predicted approach, for what the step's forces and impulses add.
constexpr double kSpare = 1.25;
constexpr double kStraight = 0.1;  // [rad] in a step: with less a gap has only one minimum
constexpr double kRotated = 0.01;  // [rad] in a step: less changes no normal
// Fraction of the closing speed before, at which the closest approach is reached.
constexpr double kGrazing = 0.01;
// Cosine of the angle within which two normals count as the same: 0.2 degrees.
constexpr double kUnchangedNormal = 0.999994;

// The points x of the two motions after a time.
struct Moment {
  const PairMotion& motion;
  Vec3 x_a, x_b;

  Moment(const PairMotion& of, double t)
      : motion(of), x_a(of.a.x + t * of.a.v), x_b(of.b.x + t * of.b.v) {}

  // Of a's point there relative to b's.
  Vec3 velocity(const Vec3& at) const {
    const Motion &a = motion.a, &b = motion.b;
    return a.v + cross(a.w, at - x_a) - b.v - cross(b.w, at - x_b);
  }
};

// The point of a manifold that closes first.
struct Closing {
  double gap = 0.0;    // [m]
  double speed = 0.0;  // [m/s], > 0: it closes
  Vec3 velocity;       // of a's point relative to b's [m/s]
};

Closing first_to_close(const Moment& moment, const Manifold& m, double tolerance) {
  Closing first;
  double least = std::numeric_limits<double>::infinity();
  for (int i = 0; i < m.count; ++i) {
    const ManifoldPoint& p = m.points[i];
    const Vec3 velocity = moment.velocity(p.position);
    const double speed = dot(m.normal, velocity);
    const double time = speed > 0.0 ? (p.separation + tolerance) / speed : 1e30 * (1.0 - speed);
    if (time >= least) continue;
    least = time;
    first = {p.separation, speed, velocity};
  }
  return first;
}

// How fast the shape itself rotates: about its axis of symmetry it does not [rad/s].
double rotation_of(const Geometry& shape, const SE3& T, const Vec3& w) {
  switch (shape.kind) {
    case Kind::sphere:
      return 0.0;
    case Kind::capsule:
    case Kind::cylinder:
    case Kind::cone:
      return norm(cross(w, T.rotation().cz));
    default:
      return norm(w);
  }
}

// Of the patch of the points; infinite if there is only one point, where a round surface touches.
double width_of(const Manifold& m) {
  if (m.count == 1) return std::numeric_limits<double>::infinity();
  double length = 0.0, area = 0.0;
  for (int i = 0; i < m.count; ++i) {
    for (int j = 0; j < i; ++j) {
      const Vec3 edge = m.points[i].position - m.points[j].position;
      length = std::max(length, norm(edge));
      for (int k = 0; k < j; ++k)
        area = std::max(area, norm(cross(edge, m.points[k].position - m.points[j].position)));
    }
  }
  return length > 0.0 ? area / length : 0.0;
}

// A wide patch of two bodies that hardly slide or rotate has the same normal at the impact.
bool may_change_normal(const PairMotion& motion, const Manifold& m, const Closing& first) {
  const double rotation = std::max(norm(motion.a.w), norm(motion.b.w));
  const Vec3 sliding = first.velocity - first.speed * m.normal;
  return motion.dt * rotation > kRotated || motion.dt * norm(sliding) > motion.tolerance ||
         width_of(m) < motion.tolerance;
}

bool overlaps(const Manifold& m, double depth) {
  for (int i = 0; i < m.count; ++i)
    if (m.points[i].separation <= -depth) return true;
  return false;
}

}  // namespace

MotionToImpact move_to_impact(const Geometry& a, const SE3& T_a, const Geometry& b, const SE3& T_b,
                              const PairMotion& motion, double margin, Manifold& manifold) {
  const double tolerance = motion.tolerance, latest = 2.0 * motion.dt;
  // The normal of a half-space never changes.
  if (a.kind == Kind::half_space || b.kind == Kind::half_space || overlaps(manifold, tolerance))
    return {};
  Closing last, next = first_to_close(Moment(motion, 0.0), manifold, tolerance);
  // What rests and what does not come so far keep their contact.
  const double closes = motion.dt * next.speed;
  if (closes <= kResting * tolerance || kSpare * closes <= next.gap) return {};
  if (!may_change_normal(motion, manifold, next)) return {};
  Manifold m = manifold;
  double t = 0.0, step = 0.0;
  const auto advance = [&](double by) {
    step = by;
    t += by;
    find_manifold(a, pose_at({&a, T_a, motion.a}, t), b, pose_at({&b, T_b, motion.b}, t), margin,
                  m);
    last = next;
    next = first_to_close(Moment(motion, t), m, tolerance);
    return m.count > 0;
  };
  if (!advance(std::min((next.gap + tolerance) / next.speed, latest))) return {};
  for (int i = 0; i < kMaxRefinements && !overlaps(m, kReached * tolerance); ++i) {
    // Where they graze each other, closing slows down: the gap follows a parabola.
    const double slowing = (last.speed - next.speed) / step;
    if (std::fabs(next.speed) < kGrazing * last.speed) break;
    if (next.speed < 0.0 && !(slowing > 0.0)) break;
    double by = (next.gap + tolerance) / next.speed;
    if (slowing > 0.0) {
      const double reach = next.speed * next.speed - 2.0 * slowing * (next.gap + tolerance);
      by = reach > 0.0 && next.speed > 0.0
               ? 2.0 * (next.gap + tolerance) / (next.speed + std::sqrt(reach))
               : (next.speed - std::sqrt(std::max(reach, 0.0))) / slowing;
    }
    if (!(t + by >= 0.0 && t + by <= latest)) break;
    if (!advance(by)) return {};
  }
  const bool reached = overlaps(m, kReached * tolerance);
  // They open: this is the far side.
  if (reached && next.speed < 0.0) return {};
  // What rotates may come closer again.
  if (!reached &&
      motion.dt * std::max(rotation_of(a, T_a, motion.a.w), rotation_of(b, T_b, motion.b.w)) >
          kStraight)
    return {};
  if (dot(m.normal, manifold.normal) > kUnchangedNormal || overlaps(m, kTooDeep * tolerance))
    return {};
  const Moment impact(motion, t);
  for (int i = 0; i < m.count; ++i) {
    ManifoldPoint& p = m.points[i];
    // A point that opens was deeper before; as such it would push them apart at once.
    p.separation += t * std::max(dot(m.normal, impact.velocity(p.position)), 0.0);
  }
  if (overlaps(m, kStartDepth * tolerance)) return {};
  manifold = m;
  return {t * motion.a.v, t * motion.b.v};
}

}  // namespace vp::collide
