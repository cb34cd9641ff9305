#include "collide/pair_margin.h"

#include <algorithm>
#include <utility>

#include "collide/support.h"

namespace vp::collide {
namespace {

// A point at an arm r from the axis leaves the straight line between the ends of its path by at
// most this times r angle^2.
constexpr double kCurvature = 0.125;

Vec3 vector_part(const Quaternion& q) {
  return {q.x, q.y, q.z};
}
// What the rotation adds to v.
Vec3 rotated_by(const Quaternion& q, const Vec3& v) {
  const Vec3 u = vector_part(q), first = cross(u, v);
  return 2.0 * (q.w * first + cross(u, first));
}

double height(const Geometry& shape, const Vec3& n) {
  int hint = 0;
  return dot(n, core_support(shape, n, hint));
}

// How much farther the shape reaches along n after a rotation about its origin.
double reaches_by_rotation(const Posed& a, const Vec3& n, const Quaternion& rotation) {
  if (vector_part(rotation) == Vec3{}) return 0.0;
  const Vec3 now = a.T.unrotate(n), later = a.T.unrotate(n + rotated_by(conjugate(rotation), n));
  return height(a.shape, later) - height(a.shape, now);
}

// Of a shape until the next search.
struct Path {
  Quaternion rotation;
  Vec3 displacement;  // of its origin [m]
  double curvature;   // of its points' paths: their largest distance from straight lines [m]

  Path(const Motion& m, double dt, const Posed& a) : rotation(exp_quaternion(dt * m.w)) {
    const Vec3 arm = a.T.position() - m.x;
    displacement = dt * m.v + rotated_by(rotation, arm);
    const double reach = norm(arm) + norm(core_centre(a.shape)) + core_extent(a.shape);
    curvature = kCurvature * dt * dt * dot(m.w, m.w) * reach;
  }
};

bool is_rotating_half_space(const Motion& m, const Posed& a) {
  return a.shape.kind == Kind::half_space && !(m.w == Vec3{});
}

}  // namespace

PairMargin::PairMargin(double largest, double slack, const PairMotion& motion, const Posed& a,
                       const Posed& b)
    : PairMargin(largest) {
  if (is_rotating_half_space(motion.a, a) || is_rotating_half_space(motion.b, b)) return;
  const Path of_a(motion.a, motion.dt, a), of_b(motion.b, motion.dt, b);
  slack_ = std::min(largest, slack + of_a.curvature + of_b.curvature);
  displacement_ = of_a.displacement - of_b.displacement;
  rotation_a_ = of_a.rotation;
  rotation_b_ = of_b.rotation;
}

double PairMargin::closing(const Vec3& n, const Posed& a, const Posed& b) const {
  return dot(n, displacement_) + reaches_by_rotation(a, n, rotation_a_) +
         reaches_by_rotation(b, -n, rotation_b_);
}

bool PairMargin::passes_beside(const Posed& a, const Posed& b) const {
  if (a.shape.kind == Kind::half_space || b.shape.kind == Kind::half_space) return false;
  const Vec3 &u = displacement_, centres = b.T * core_centre(b.shape) - a.T * core_centre(a.shape);
  const double length2 = dot(u, u);
  if (!(length2 > 0.0)) return false;
  const Vec3 beside = centres - (dot(centres, u) / length2) * u;
  const double distance = norm(beside);
  if (!(distance > slack_)) return false;
  const Vec3 n = (1.0 / distance) * beside;
  const double reach_a = height(a.shape, a.T.unrotate(n)),
               reach_b = height(b.shape, -b.T.unrotate(n));
  const double separation = dot(n, b.T.position() - a.T.position()) - reach_a - reach_b -
                            core_radius(a.shape) - core_radius(b.shape);
  return separation > slack_ && separation - closing(n, a, b) > slack_;
}

PairMargin PairMargin::reversed() const {
  PairMargin other = *this;
  other.displacement_ = -displacement_;
  std::swap(other.rotation_a_, other.rotation_b_);
  return other;
}

PairMargin PairMargin::in_frame(const SE3& T) const {
  if (slack_ >= largest_) return *this;  // the motion does not matter
  const auto local = [&](const Quaternion& q) {
    const Vec3 u = T.unrotate(vector_part(q));
    return Quaternion{u.x, u.y, u.z, q.w};
  };
  PairMargin other = *this;
  other.displacement_ = T.unrotate(displacement_);
  other.rotation_a_ = local(rotation_a_);
  other.rotation_b_ = local(rotation_b_);
  return other;
}

}  // namespace vp::collide
