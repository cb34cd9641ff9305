// Coordinates of a joint, and how fast they change.
//
// With a's frame at p_a, axes R_a, b's at p_b, R_b, arms r from the centres of mass, d = p_b - p_a:
//
//   c_i = e_i . d,  e_i a's axis                        along e_i
//   c_i' = e_i . (v_b + w_b x r_b - v_a) - ((r_a + d) x e_i) . w_a
//
// Turning, in a's frame, w = R_a^T (w_b - w_a), R = R_a^T R_b with third column
// (sin s k_y, -sin s k_x, cos s), s the swing about the unit vector k across z, r = s k:
//
//   r'     = [k k^T + s cot(s) g g^T - g r_g z^T] w,  g = (k_y, -k_x),  r_g = s
//   twist  = atan2(R_10 - R_01, R_00 + R_11),  twist' = (z_a + z_b) . w / (1 + cos s)
//
// Source: for swing and twist, Shoemake, Fiber Bundle Twist Reduction, Graphics Gems IV, 1994.
#include <algorithm>
#include <cmath>

#include "world/joint.h"
#include "world/validate.h"

namespace vp {
namespace {

using solve::JointRow6;
using solve::Twelve;

constexpr int kTwist = static_cast<int>(JointAxis::turn_z);

struct Ends {
  Mat3 R_a, R_b;
  Vec3 r_a, r_b, d;

  Ends(const BodyJoint& joint, const BodyPlace& a, const BodyPlace& b)
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

// Of n . d, n a's.
Twelve along(const Ends& e, const Vec3& n) {
  return {-n, -cross(e.r_a + e.d, n), n, cross(e.r_b, n)};
}
// Of what changes by m . (w_b - w_a).
Twelve about(const Vec3& m) {
  return {{}, -m, {}, m};
}

// The swing's vector and its derivatives, in a's frame.
struct Swing {
  double x, y, angle, cosine;
  Vec3 by_x, by_y, z_b;

  explicit Swing(const Ends& e) : z_b(transposed_times(e.R_a, e.R_b.cz)) {
    const double sine = std::sqrt(z_b.x * z_b.x + z_b.y * z_b.y);
    cosine = z_b.z;
    angle = arc_tangent(sine, cosine);
    // s / sin(s) and (1 - s cot(s)) / s^2
    double ratio = 1.0, curve = 1.0 / 3.0;
    if (angle > 1e-4) {
      ratio = angle / std::max(sine, 1e-9);
      curve = (1.0 - ratio * cosine) / (angle * angle);
    }
    x = -ratio * z_b.y;
    y = ratio * z_b.x;
    const Vec3 g{y, -x, 0.0};
    by_x = Vec3{1.0, 0.0, -y} - curve * y * g;
    by_y = Vec3{0.0, 1.0, x} + curve * x * g;
  }
};

double twist_of(const Ends& e) {
  const Vec3 x = transposed_times(e.R_a, e.R_b.cx), y = transposed_times(e.R_a, e.R_b.cy);
  return arc_tangent(x.y - y.x, x.x + y.y);
}
Vec3 twist_rate(const Ends& e) {
  return (1.0 / std::max(1e-3, 1.0 + dot(e.R_a.cz, e.R_b.cz))) * (e.R_a.cz + e.R_b.cz);
}

// The angle that is the same but for whole turns, and nearest to the last. The last one stays where
// bodies have left the range within a step: the step's end puts them back.
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
double gear_way(const SE3& start, const SE3& now, const SE3& T_body_joint) {
  const Vec3 z = start.rotation() * T_body_joint.rotation().cz;
  return dot(z, now * T_body_joint.position() - start * T_body_joint.position());
}
double gear_side(const BodyJoint& joint, const SE3& now, int side) {
  const SE3& T = side == 0 ? joint.T_a_joint : joint.T_b_joint;
  const bool slides = side == 0 ? joint.law.slides_a : joint.law.slides_b;
  if (slides) return gear_way(joint.start[side], now, T);
  return counted_on(joint.turned[side], gear_angle(joint.start[side], now, T));
}

void evaluate_axes(BodyJoint& joint, const BodyPlace& a, const BodyPlace& b) {
  const Ends e(joint, a, b);
  const Swing swing(e);
  if (joint.law.axes[kTwist].motion != AxisMotion::locked)
    joint.turned[0] = counted_on(joint.turned[0], twist_of(e));
  for (int i = 0; i < joint.block.count; ++i) {
    JointRow6& row = joint.block.rows[i];
    if (row.slot < 3) {
      const Vec3& n = column(e.R_a, row.slot);
      row.jacobian = along(e, n);
      row.residual = dot(n, e.d);
    } else if (row.slot == kTwist) {
      row.jacobian = about(twist_rate(e));
      row.residual =
          joint.law.axes[kTwist].motion == AxisMotion::locked ? twist_of(e) : joint.turned[0];
    } else if (joint.law.cone) {
      // The way to the cone: (1 - f) / |grad f| with f^2 = (x / swing_x)^2 + (y / swing_y)^2.
      const double sx = joint.law.swing_x, sy = joint.law.swing_y;
      const double f = std::sqrt(swing.x * swing.x / (sx * sx) + swing.y * swing.y / (sy * sy));
      double gx = swing.x / (sx * sx), gy = swing.y / (sy * sy);
      const double g = std::sqrt(gx * gx + gy * gy);
      if (g > 1e-12) {
        gx /= g;
        gy /= g;
        row.residual = (1.0 - f) * f / g;
      } else {
        gx = 1.0;
        gy = 0.0;
        row.residual = std::min(sx, sy);
      }
      row.jacobian = about(e.R_a * (-gx * swing.by_x - gy * swing.by_y));
    } else {
      const bool is_x = row.slot == 3;
      row.jacobian = about(e.R_a * (is_x ? swing.by_x : swing.by_y));
      row.residual = is_x ? swing.x : swing.y;
    }
  }
}

void evaluate_distance(BodyJoint& joint, const BodyPlace& a, const BodyPlace& b) {
  const Ends e(joint, a, b);
  const double length = norm(e.d);
  const Vec3 n = length > 1e-9 ? (1.0 / length) * e.d : e.R_a.cx;
  for (int i = 0; i < joint.block.count; ++i) {
    JointRow6& row = joint.block.rows[i];
    row.jacobian = {-n, -cross(e.r_a, n), n, cross(e.r_b, n)};
    row.residual = i < joint.block.held ? length - row.position : length;
  }
}

void evaluate_gear(BodyJoint& joint, const BodyPlace& a, const BodyPlace& b) {
  const double q_a = gear_side(joint, a.T, 0), q_b = gear_side(joint, b.T, 1);
  if (!joint.law.slides_a) joint.turned[0] = q_a;
  if (!joint.law.slides_b) joint.turned[1] = q_b;
  const Ends e(joint, a, b);
  JointRow6& row = joint.block.rows[0];
  const Vec3 &z_a = e.R_a.cz, &z_b = e.R_b.cz;
  Twelve& J = row.jacobian;
  J = {};
  const double ratio = joint.law.ratio;
  if (joint.law.slides_a) {
    const Vec3 z = joint.start[0].rotation() * joint.T_a_joint.rotation().cz;
    J.linear_a = -ratio * z;
    J.angular_a = -ratio * cross(e.r_a, z);
  } else {
    J.angular_a = -ratio * z_a;
  }
  if (joint.law.slides_b) {
    const Vec3 z = joint.start[1].rotation() * joint.T_b_joint.rotation().cz;
    J.linear_b = z;
    J.angular_b = cross(e.r_b, z);
  } else {
    J.angular_b = z_b;
  }
  row.residual = q_b - ratio * q_a;
}

// From a body's frame, about its origin, to world axes about its centre of mass.
void carry_over(const BodyPlace& body, const dse3& F, Vec3& linear, Vec3& angular) {
  linear = body.T.rotate(F.f);
  angular = body.T.rotate(F.m) - cross(body.centre - body.T.position(), linear);
}
bool finite(const Twelve& J) {
  const double sum = dot(J.linear_a, J.linear_a) + dot(J.angular_a, J.angular_a) +
                     dot(J.linear_b, J.linear_b) + dot(J.angular_b, J.angular_b);
  return sum <= 1e18;
}

void evaluate_user(BodyJoint& joint, const BodyPlace& a, const BodyPlace& b) {
  double residual[6] = {};
  PairRow rows[6];
  const auto n = static_cast<std::size_t>(joint.law.user_rows);
  joint.law.user->evaluate(a.T, b.T, std::span(residual, n), std::span(rows, n));
  for (int i = 0; i < joint.block.count; ++i) {
    JointRow6& row = joint.block.rows[i];
    Twelve& J = row.jacobian;
    carry_over(a, rows[row.slot].a, J.linear_a, J.angular_a);
    carry_over(b, rows[row.slot].b, J.linear_b, J.angular_b);
    row.residual = residual[row.slot];
    if (finite(J) && std::fabs(row.residual) <= 1e9) continue;
    J = {};
    row.residual = 0.0;
  }
}

}  // namespace

void evaluate(BodyJoint& joint, const BodyPlace& a, const BodyPlace& b) {
  switch (joint.law.form) {
    case JointLaw::Form::axes:
      return evaluate_axes(joint, a, b);
    case JointLaw::Form::distance:
      return evaluate_distance(joint, a, b);
    case JointLaw::Form::gear:
      return evaluate_gear(joint, a, b);
    case JointLaw::Form::user:
      return evaluate_user(joint, a, b);
  }
}

std::optional<double> coordinate(const BodyJoint& joint, const BodyPlace& a, const BodyPlace& b,
                                 int slot) {
  const JointLaw& law = joint.law;
  if (law.form == JointLaw::Form::user) {
    if (slot >= law.user_rows) return std::nullopt;
    double residual[6] = {};
    PairRow rows[6];
    const auto n = static_cast<std::size_t>(law.user_rows);
    law.user->evaluate(a.T, b.T, std::span(residual, n), std::span(rows, n));
    return residual[slot];
  }
  const Ends e(joint, a, b);
  if (law.form == JointLaw::Form::axes) {
    if (slot < 3) return dot(column(e.R_a, slot), e.d);
    if (slot == kTwist) return counted_on(joint.turned[0], twist_of(e));
    const Swing swing(e);
    return slot == 3 ? swing.x : swing.y;
  }
  if (slot != 0) return std::nullopt;
  if (law.form == JointLaw::Form::distance) return norm(e.d);
  return gear_side(joint, b.T, 1) - law.ratio * gear_side(joint, a.T, 0);
}

}  // namespace vp
