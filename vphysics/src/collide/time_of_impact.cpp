// Conservative advancement of second order, for rotating shapes.
//
// A separating direction n bounds the separation from below by the separation g of the projections
// on it. Let n rotate at a rate O that is zero or that of one of the bodies, so that it can follow
// a face's normal. The projection of a point r of a body, relative to the body's centre of
// rotation, with the angular velocity w, changes as
//     d/ds   n . r = r . (n x (w - O)),
//     d^2/ds^2     = r . (w x m - (w - O) x (O x n)),      m = (w - O) x n,
// which is at most |w - O| (|w| + |O x n|) |r|, or |w| |w x n| |r| if O = 0. The displacement D
// between the centres of rotation, which changes at v, gives
//     d/ds   n . D = n . v + D . (O x n),     |d^2/ds^2| <= |O x n| (|O| |D| + 2 |v|).
// With A the sum of these bounds over the bodies and D, and h the support functions of the bodies
// about their centres of rotation,
//     g(s) >= n . D + s (n . v + D . (O x n)) - h_b(-n - s n x (w_b - O))
//             - h_a(n + s n x (w_a - O)) - A s^2 / 2.
// The right side is concave: if it is above the target at some s, it is so at all earlier ones. It
// needs support functions only; GJK gives the next n. If the direction is right, the error is of
// second order in s: a rod at 150 rad/s needs a handful of steps.
//
// Sources: Mirtich, Impulse-based Dynamic Simulation, 1996, section 2.3 (advancement); Zhang, Lee,
// Kim, Interactive continuous collision detection for non-convex polyhedra, 2006 (along
// directions); the second-order bound is derived here.
#include "collide/time_of_impact.h"

#include <algorithm>
#include <cmath>

#include "collide/distance.h"

namespace vp::collide {
namespace {

constexpr int kMaxAdvances = 200;
// Fractions of the tolerance: the aim of a step, and the slack below it.
constexpr double kAim = 0.5, kSlack = 0.25;

bool is_turning(const Vec3& w) {
  return w.x != 0.0 || w.y != 0.0 || w.z != 0.0;
}

// Relative to the first shape's position at time 0, so that shapes far from the origin lose no
// precision.
MovingShape shifted(const MovingShape& m, const Vec3& origin) {
  MovingShape s{m.shape, SE3(m.T.rotation(), m.T.position() - origin), m.motion};
  s.motion.x = m.motion.x - origin;
  // For a shape that does not rotate, the core's centre serves as the centre of rotation: it gives
  // the least bounding radius.
  if (!is_turning(m.motion.w)) s.motion.x = s.T * core_centre(*m.shape);
  return s;
}

// A shape at some time, relative to its centre of rotation.
struct TurningShape {
  const Geometry* shape;
  Mat3 R;
  Vec3 arm;  // to the origin of its frame
  Vec3 w;
  double rate, extent;
  mutable int hint = 0;

  TurningShape(const MovingShape& m, double time)
      : shape(m.shape),
        R(m.T.rotation()),
        arm(m.T.position() - m.motion.x),
        w(m.motion.w),
        rate(norm(w)) {
    if (is_turning(w)) {
      const Mat3 rotation = Exp(time * w).matrix();
      R = rotation * R;
      arm = rotation * arm;
    }
    extent = norm(arm + R * core_centre(*shape)) + core_extent(*shape);
  }
  Vec3 support(const Vec3& d) const {
    return arm + R * core_support(*shape, transposed_times(R, d), hint);
  }
};

struct Pair {
  TurningShape a, b;
  Vec3 D, v;  // from a's centre of rotation to b's, and its derivative
  double radii;

  Pair(const ImpactQuery& q, double t)
      : a(q.a, t),
        b(q.b, t),
        D((q.b.motion.x - q.a.motion.x) + t * (q.b.motion.v - q.a.motion.v)),
        v(q.b.motion.v - q.a.motion.v),
        radii(core_radius(*q.a.shape) + core_radius(*q.b.shape)) {}
};

// The lower bound of the separation along n, which rotates at a rate.
class SeparationBound {
 public:
  SeparationBound(const Pair& pair, const Vec3& n, const Vec3& rate, double horizon)
      : pair_(pair),
        n_(n),
        angular_a_(cross(n, pair.a.w - rate)),
        angular_b_(cross(n, pair.b.w - rate)),
        separation_(dot(n, pair.D) - pair.radii),
        derivative_(dot(n, pair.v) + dot(pair.D, cross(rate, n))) {
    const double turning = norm(cross(rate, n)), speed = norm(pair.v);
    const auto bend = [&](const TurningShape& s) {
      const double tangential = is_turning(rate) ? norm(s.w - rate) : norm(cross(s.w, n));
      return tangential * (s.rate + turning) * s.extent;
    };
    bend_ = bend(pair.a) + bend(pair.b) +
            turning * (norm(rate) * (norm(pair.D) + speed * horizon) + 2.0 * speed);
  }

  struct Value {
    double separation, slope;
  };
  Value at(double s) const {
    const Vec3 towards_b = n_ + s * angular_a_, towards_a = -n_ - s * angular_b_;
    const Vec3 on_a = pair_.a.support(towards_b), on_b = pair_.b.support(towards_a);
    return {separation_ + s * (derivative_ - 0.5 * bend_ * s) - dot(on_b, towards_a) -
                dot(on_a, towards_b),
            derivative_ - bend_ * s + dot(on_b, angular_b_) - dot(on_a, angular_a_)};
  }
  // A time, at most the horizon, up to which the bound stays above goal - slack. Precondition: it
  // is above goal now.
  double safe_time(double goal, double slack, double horizon) const;

 private:
  const Pair& pair_;
  Vec3 n_, angular_a_, angular_b_;
  double separation_, derivative_, bend_;
};

double SeparationBound::safe_time(double goal, double slack, double horizon) const {
  double left = 0.0;
  Value at_left = at(0.0);
  // The parabola of the bodies' current support points is above the bound. The time at which it
  // reaches the goal is an upper bound, and exact while these remain the support points.
  const double f = at_left.separation - goal, b = at_left.slope;
  if (!(f > 0.0)) return 0.0;  // rounding errors of GJK
  const double root = std::sqrt(b * b + 2.0 * bend_ * f);
  const double down = b < 0.0 ? 2.0 * f / (root - b) : bend_ > 0.0 ? (b + root) / bend_ : horizon;
  double right = std::min(down, horizon);
  Value at_right = at(right);
  constexpr int kMaxIterations = 12;
  constexpr double kNear = 0.02;  // fraction of the step
  for (int iteration = 0; iteration < kMaxIterations; ++iteration) {
    if (at_right.separation >= goal - slack) return right;
    if (right - left <= kNear * right) break;
    // A concave function is above its chord and below its tangent.
    const double chord = left + (right - left) * (at_left.separation - goal) /
                                    (at_left.separation - at_right.separation);
    left = std::clamp(chord, left, right);
    at_left = at(left);
    if (at_right.slope < 0.0) {
      right = std::clamp(right - (at_right.separation - goal) / at_right.slope, left, right);
      at_right = at(right);
    }
  }
  return left;
}

double longest_step(const Pair& pair, const Vec3& n, double goal, double slack, double horizon) {
  double step = 0.0;
  const auto rotation_at = [&](const Vec3& rate) {
    step = std::max(step, SeparationBound(pair, n, rate, horizon).safe_time(goal, slack, horizon));
  };
  // A half-space has a support point only along its normal.
  if (pair.a.shape->kind == Kind::half_space) {
    rotation_at(pair.a.w);
  } else if (pair.b.shape->kind == Kind::half_space) {
    rotation_at(pair.b.w);
  } else {
    rotation_at({});
    if (is_turning(pair.a.w)) rotation_at(pair.a.w);
    if (is_turning(pair.b.w) && pair.b.w != pair.a.w) rotation_at(pair.b.w);
  }
  return step;
}

}  // namespace

SE3 pose_at(const MovingShape& m, double time) {
  const Vec3 arm = m.T.position() - m.motion.x, x = m.motion.x + time * m.motion.v;
  if (!is_turning(m.motion.w)) return {m.T.rotation(), x + arm};
  const Mat3 rotation = Exp(time * m.motion.w).matrix();
  return {rotation * m.T.rotation(), x + rotation * arm};
}

double time_of_impact(const ImpactQuery& query, double target, PairCache& cache, double latest) {
  const Vec3 origin = query.a.T.position();
  const ImpactQuery q{shifted(query.a, origin), shifted(query.b, origin), query.duration,
                      query.tolerance};
  const double goal = target + kAim * q.tolerance, slack = kSlack * q.tolerance;
  double t = 0.0;
  for (int i = 0; i < kMaxAdvances; ++i) {
    const ClosestPoints near =
        closest_points(*q.a.shape, pose_at(q.a, t), *q.b.shape, pose_at(q.b, t), cache);
    if (near.distance <= target + q.tolerance) return t;
    const Pair pair(q, t);
    const double step = longest_step(pair, near.normal, goal, slack, q.duration - t);
    if (step == 0.0) return t;
    t += step;
    if (!(t < q.duration) || t > latest) return -1.0;
  }
  return t;  // not reached, but safe: the caller may advance to t and repeat the query
}

}  // namespace vp::collide
