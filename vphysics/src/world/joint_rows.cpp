// Coordinates of a joint, and Jacobians of rows that the SIMD passes do not evaluate: those of
// joints in rows (row_joints.h), and of distances, gears and user constraints. solve/joint_angles.h
// defines swing and twist, and the derivatives of all coordinates.
#include <algorithm>
#include <cmath>

#include "world/joint.h"
#include "world/validate.h"

namespace vp {
namespace {

constexpr int kTwist = static_cast<int>(JointAxis::rotation_z);

struct Ends {
  Mat3 R_a, R_b;
  Vec3 r_a, r_b, d;

  Ends(const BodyJoint& joint, const BodyPose& a, const BodyPose& b)
      : R_a(a.T.rotation() * joint.T_a_joint.rotation()),
        R_b(b.T.rotation() * joint.T_b_joint.rotation()) {
    const Vec3 p_a = a.T * joint.T_a_joint.position(), p_b = b.T * joint.T_b_joint.position();
    r_a = p_a - a.centre;
    r_b = p_b - b.centre;
    d = p_b - p_a;
  }
};

const Vec3& column(const Mat3& R, int i) {
  return i == 0 ? R.cx : i == 1 ? R.cy : R.cz;
}

// The swing vector and its derivatives, in a's frame.
struct Swing {
  double x, y;
  Vec3 by_x, by_y;

  explicit Swing(const Ends& e) {
    constexpr double kSeries = 0.03;
    const Vec3 z_b = transposed_times(e.R_a, e.R_b.cz);
    const double sine = std::sqrt(z_b.x * z_b.x + z_b.y * z_b.y);
    const double angle = arc_tangent(sine, z_b.z), s = angle * angle;
    const double ratio = sine > 1e-9 ? angle / sine : 1.0;
    x = -ratio * z_b.y;
    y = ratio * z_b.x;
    // (1 - angle cot(angle)) / angle^2
    const double curve = angle < kSeries ? 1.0 / 3.0 + s * (1.0 / 45.0 + s * (2.0 / 945.0))
                                         : (1.0 - ratio * z_b.z) / s;
    const Vec3 perpendicular{y, -x, 0.0};
    by_x = Vec3{1.0, 0.0, -y} - (curve * y) * perpendicular;
    by_y = Vec3{0.0, 1.0, x} + (curve * x) * perpendicular;
  }
};

double twist_of(const Ends& e) {
  const Vec3 x = transposed_times(e.R_a, e.R_b.cx), y = transposed_times(e.R_a, e.R_b.cy);
  return arc_tangent(x.y - y.x, x.x + y.y);
}
// The angle modulo 2 pi that is nearest to the last one. Keeps the last one if bodies have left the
// range of numbers within a step: the end of the step restores them.
double counted_on(double last, double angle) {
  const double counted = angle + 2.0 * kPi * std::floor((last - angle) / (2.0 * kPi) + 0.5);
  return in_range(counted) ? counted : last;
}

double gear_angle(const SE3& start, const SE3& now, const SE3& T_body_joint) {
  const Mat3 R0 = start.rotation() * T_body_joint.rotation();
  const Mat3 R1 = now.rotation() * T_body_joint.rotation();
  const Vec3 x = transposed_times(R0, R1.cx), y = transposed_times(R0, R1.cy);
  return arc_tangent(x.y - y.x, x.x + y.y);
}
double gear_position(const SE3& start, const SE3& now, const SE3& T_body_joint) {
  const Vec3 z = start.rotation() * T_body_joint.rotation().cz;
  return dot(z, now * T_body_joint.position() - start * T_body_joint.position());
}
double gear_side(const BodyJoint& joint, const SE3& now, int side) {
  const SE3& T = side == 0 ? joint.T_a_joint : joint.T_b_joint;
  const bool slides = side == 0 ? joint.spec.slides_a : joint.spec.slides_b;
  if (slides) return gear_position(joint.start[side], now, T);
  return counted_on(joint.rotated[side], gear_angle(joint.start[side], now, T));
}

// The angle to the cone, as a row that increases inwards:
//   (1 - f) / |grad f|  with  f^2 = (x / cone_x)^2 + (y / cone_y)^2.
double angle_to_cone(const JointSpec& spec, const Swing& swing, Vec3& axis) {
  const double ix = 1.0 / spec.swing_x, iy = 1.0 / spec.swing_y;
  const double sx = swing.x * ix, sy = swing.y * iy;
  const double f = std::sqrt(sx * sx + sy * sy);
  double gx = sx * ix, gy = sy * iy;
  const double g = std::sqrt(gx * gx + gy * gy);
  if (!(g > 1e-9)) {
    axis = -swing.by_x;
    return std::min(spec.swing_x, spec.swing_y);
  }
  gx /= g;
  gy /= g;
  axis = (-gx) * swing.by_x - gy * swing.by_y;
  return (1.0 - f) * f / g;
}

Vec3 twist_axis(const Ends& e) {
  return (1.0 / std::max(1.0 + dot(e.R_a.cz, e.R_b.cz), 1e-3)) * (e.R_a.cz + e.R_b.cz);
}

void evaluate_axes(BodyJoint& joint, const BodyPose& a, const BodyPose& b, JointEvaluation& out) {
  const Ends e(joint, a, b);
  const Swing swing(e);
  const double twist = twist_of(e);
  if (joint.spec.axes[kTwist].motion != AxisMotion::locked) {
    joint.rotated[0] = counted_on(joint.rotated[0], twist);
  }
  const Mat3 world = Mat3::identity();
  for (int i = 0; i < joint.count; ++i) {
    const int slot = joint.rows[i].slot;
    RowJacobian& J = out.jacobian[i];
    double& residual = out.residual[i];
    if (slot < 3) {
      const Vec3 n = column(joint.holds_point() ? world : e.R_a, slot);
      J = {-n, -cross(e.r_a + e.d, n), n, cross(e.r_b, n)};
      residual = dot(n, e.d);
      continue;
    }
    Vec3 axis;
    if (slot == kTwist) {
      axis = twist_axis(e);
      residual = i < joint.locked ? twist : joint.rotated[0];
    } else if (joint.spec.cone) {
      residual = angle_to_cone(joint.spec, swing, axis);
      axis = e.R_a * axis;
    } else {
      axis = e.R_a * (slot == 3 ? swing.by_x : swing.by_y);
      residual = slot == 3 ? swing.x : swing.y;
    }
    J = {{}, -axis, {}, axis};
  }
}

void evaluate_distance(const BodyJoint& joint, const BodyPose& a, const BodyPose& b,
                       JointEvaluation& out) {
  const Ends e(joint, a, b);
  const double length = norm(e.d);
  const Vec3 n = length > 1e-9 ? (1.0 / length) * e.d : e.R_a.cx;
  for (int i = 0; i < joint.count; ++i) {
    out.jacobian[i] = {-n, -cross(e.r_a, n), n, cross(e.r_b, n)};
    out.residual[i] = i < joint.locked ? length - joint.rows[i].position : length;
  }
}

void evaluate_gear(BodyJoint& joint, const BodyPose& a, const BodyPose& b, JointEvaluation& out) {
  const double q_a = gear_side(joint, a.T, 0), q_b = gear_side(joint, b.T, 1);
  if (!joint.spec.slides_a) joint.rotated[0] = q_a;
  if (!joint.spec.slides_b) joint.rotated[1] = q_b;
  const Ends e(joint, a, b);
  const Vec3 &z_a = e.R_a.cz, &z_b = e.R_b.cz;
  RowJacobian& J = out.jacobian[0];
  J = {};
  const double ratio = joint.spec.ratio;
  if (joint.spec.slides_a) {
    const Vec3 z = joint.start[0].rotation() * joint.T_a_joint.rotation().cz;
    J.linear_a = -ratio * z;
    J.angular_a = -ratio * cross(e.r_a, z);
  } else {
    J.angular_a = -ratio * z_a;
  }
  if (joint.spec.slides_b) {
    const Vec3 z = joint.start[1].rotation() * joint.T_b_joint.rotation().cz;
    J.linear_b = z;
    J.angular_b = cross(e.r_b, z);
  } else {
    J.angular_b = z_b;
  }
  out.residual[0] = q_b - ratio * q_a;
}

// Transforms a wrench from a body's frame, about its origin, to world axes, about its centre of
// mass.
void carry_over(const BodyPose& body, const dse3& F, Vec3& linear, Vec3& angular) {
  linear = body.T.rotate(F.f);
  angular = body.T.rotate(F.m) - cross(body.centre - body.T.position(), linear);
}
bool finite(const RowJacobian& J) {
  const double sum = dot(J.linear_a, J.linear_a) + dot(J.angular_a, J.angular_a) +
                     dot(J.linear_b, J.linear_b) + dot(J.angular_b, J.angular_b);
  return sum <= 1e18;
}

void evaluate_user(const BodyJoint& joint, const BodyPose& a, const BodyPose& b,
                   JointEvaluation& out) {
  double residual[6] = {};
  PairRow rows[6];
  const auto n = static_cast<std::size_t>(joint.spec.user_rows);
  joint.spec.user->evaluate(a.T, b.T, std::span(residual, n), std::span(rows, n));
  for (int i = 0; i < joint.count; ++i) {
    const int slot = joint.rows[i].slot;
    RowJacobian& J = out.jacobian[i];
    carry_over(a, rows[slot].a, J.linear_a, J.angular_a);
    carry_over(b, rows[slot].b, J.linear_b, J.angular_b);
    out.residual[i] = residual[slot];
    if (finite(J) && std::fabs(out.residual[i]) <= 1e9) continue;
    J = {};
    out.residual[i] = 0.0;
  }
}

}  // namespace

void evaluate(BodyJoint& joint, const BodyPose& a, const BodyPose& b, JointEvaluation& out) {
  switch (joint.spec.form) {
    case JointSpec::Form::axes:
      return evaluate_axes(joint, a, b, out);
    case JointSpec::Form::distance:
      return evaluate_distance(joint, a, b, out);
    case JointSpec::Form::gear:
      return evaluate_gear(joint, a, b, out);
    case JointSpec::Form::user:
      return evaluate_user(joint, a, b, out);
  }
}

void count_revolutions(BodyJoint& joint, const BodyPose& a, const BodyPose& b) {
  if (joint.spec.axes[kTwist].motion == AxisMotion::locked) return;
  joint.rotated[0] = counted_on(joint.rotated[0], twist_of(Ends(joint, a, b)));
}

std::optional<double> coordinate(const BodyJoint& joint, const BodyPose& a, const BodyPose& b,
                                 int slot) {
  const JointSpec& spec = joint.spec;
  if (spec.form == JointSpec::Form::user) {
    if (slot >= spec.user_rows) return std::nullopt;
    double residual[6] = {};
    PairRow rows[6];
    const auto n = static_cast<std::size_t>(spec.user_rows);
    spec.user->evaluate(a.T, b.T, std::span(residual, n), std::span(rows, n));
    return residual[slot];
  }
  const Ends e(joint, a, b);
  if (spec.form == JointSpec::Form::axes) {
    if (slot < 3) return dot(column(e.R_a, slot), e.d);
    if (slot == kTwist) return counted_on(joint.rotated[0], twist_of(e));
    const Swing swing(e);
    return slot == 3 ? swing.x : swing.y;
  }
  if (slot != 0) return std::nullopt;
  if (spec.form == JointSpec::Form::distance) return norm(e.d);
  return gear_side(joint, b.T, 1) - spec.ratio * gear_side(joint, a.T, 0);
}

}  // namespace vp
