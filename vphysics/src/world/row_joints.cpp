#include "world/row_joints.h"

#include <algorithm>
#include <cmath>

#include "world/solver_limits.h"
#include "world/validate.h"

namespace vp {
namespace {

// Fraction of an error that an instant corrects.
constexpr double kCorrected = 0.5;
// G of hard constraints in sub-steps, as a fraction of K. It limits the impulses of contradictory
// rows to the speed of error correction divided by G.
constexpr double kRowLoss = 0.005;
constexpr double kUnbounded = 1e30;

bool is_angle(const BodyJoint& joint, const BodyJointRow& row) {
  return joint.spec.form == JointSpec::Form::axes && row.slot >= solve::kSwingX;
}

class RowsOfJoint {
 public:
  RowsOfJoint(BodyJoint& joint, std::uint32_t index, const RowJointStep& step, const Vec3& anchor,
              const JointEvaluation& measure, const double* speeds, const double* curves,
              std::vector<solve::JointRow>& rows, std::vector<solve::JointPair>& pairs)
      : joint_(joint),
        index_(index),
        step_(step),
        anchor_(anchor),
        measure_(measure),
        speeds_(speeds),
        curves_(curves),
        rows_(rows),
        pairs_(pairs) {}

  void add(int i) {
    const BodyJointRow& row = joint_.rows[i];
    if (i < joint_.locked) return add_locked(i, -kUnbounded, kUnbounded);
    if (row.bounded_hold) return add_bounded(i);
    add_drive(i);
    add_stops(i);
  }

 private:
  double residual(int i) const { return measure_.residual[i]; }
  double fastest(const BodyJointRow& row) const {
    return is_angle(joint_, row) ? double{solve::kMaxAngularBias}
                                 : kMaxJointCorrectionSpeed * step_.speed_unit;
  }
  bool in_instant() const { return step_.of != RowsOf::sub_step; }

  std::pair<solve::JointRow&, solve::JointPair&> add_row(int i, bool of_stop, double lower,
                                                         double upper) {
    solve::JointRow& row = rows_.emplace_back();
    row.articulation = solve::kNoPair;
    row.pair = static_cast<std::uint32_t>(pairs_.size());
    row.lower = lower;
    row.upper = upper;
    solve::JointPair& pair = pairs_.emplace_back();
    const RowJacobian& J = measure_.jacobian[i];
    pair.a.body = joint_.a;
    pair.a.linear = J.linear_a;
    pair.a.angular = J.angular_a;
    pair.b.body = joint_.b;
    pair.b.linear = J.linear_b;
    pair.b.angular = J.angular_b;
    pair.joint = index_;
    pair.row = static_cast<std::uint32_t>(i);
    pair.of_stop = of_stop;
    pair.anchor = anchor_;
    if (step_.with_memory()) {
      const double before = of_stop ? joint_.stop[i] : joint_.impulse[i];
      row.impulse = std::clamp(step_.fraction * before, lower, upper);
    }
    return {row, pair};
  }

  // Corrects an error: by velocities, or by moving the bodies.
  void take_out(const BodyJointRow& from, double error, solve::JointRow& row,
                solve::JointPair& pair) const {
    const double max_speed = fastest(from);
    if (from.relaxes && in_instant()) {
      const double range = max_speed * step_.h;
      if (step_.with_memory()) pair.error = std::clamp(kCorrected * error, -range, range);
      return;
    }
    row.target = -std::clamp(from.rate * error, -max_speed, max_speed);
    pair.loss = from.relaxes ? kRowLoss : from.loss;
    pair.relaxes = from.relaxes;
  }

  void add_locked(int i, double lower, double upper) {
    const BodyJointRow& from = joint_.rows[i];
    if (!from.relaxes && !step_.with_memory()) return;
    const auto [row, pair] = add_row(i, false, lower, upper);
    take_out(from, residual(i), row, pair);
    if (from.relaxes && step_.of == RowsOf::first_instant) {
      pair.curve = std::clamp(curves_[i], -fastest(from), fastest(from));
    }
  }

  // If its bounds make it one-sided, an open separation may close within the rest of the step.
  void add_bounded(int i) {
    const BodyJointRow& from = joint_.rows[i];
    const double C = residual(i);
    const bool open = (from.min_impulse >= 0.0 && C > 0.0) || (from.max_impulse <= 0.0 && C < 0.0);
    // A bounded force has no time to act in an impact.
    const auto bound = [&](double x) {
      return step_.with_memory() || std::fabs(x) >= BodyJointRow::kNoBound ? x : 0.0;
    };
    const double lower = bound(from.min_impulse), upper = bound(from.max_impulse);
    if (!open) return add_locked(i, lower, upper);
    const auto [row, pair] = add_row(i, false, lower, upper);
    row.target = pair.relaxed_target = -C / step_.left;
  }

  void add_drive(int i) {
    const BodyJointRow& from = joint_.rows[i];
    if (!(from.max_impulse > from.min_impulse) || !step_.with_memory()) return;
    solve::JointPair& pair = add_row(i, false, from.min_impulse, from.max_impulse).second;
    pair.drives = true;
    pair.stiffness = from.stiffness;
    pair.damping = from.damping;
    pair.drive_error = residual(i) - from.position;
    pair.drive_speed = from.speed;
  }

  void add_stops(int i) {
    const BodyJointRow& from = joint_.rows[i];
    const double range = stop_range(step_.left, speeds_[i]);
    if (residual(i) - from.lower < range) add_stop(i, residual(i) - from.lower, true);
    if (from.upper - residual(i) < range) add_stop(i, from.upper - residual(i), false);
  }
  void add_stop(int i, double distance, bool at_lower) {
    const BodyJointRow& from = joint_.rows[i];
    const double side = at_lower ? 1.0 : -1.0;
    if (distance < 0.0 && !from.relaxes && !step_.with_memory()) return;
    const auto [row, pair] =
        add_row(i, true, at_lower ? 0.0 : -kUnbounded, at_lower ? kUnbounded : 0.0);
    if (distance < 0.0) return take_out(from, side * distance, row, pair);
    row.target = pair.relaxed_target = -side * distance / step_.left;
  }

  BodyJoint& joint_;
  std::uint32_t index_;
  const RowJointStep& step_;
  const Vec3& anchor_;
  const JointEvaluation& measure_;
  const double *speeds_, *curves_;  // of each row
  std::vector<solve::JointRow>& rows_;
  std::vector<solve::JointPair>& pairs_;
};

}  // namespace

bool is_in_rows(const Bodies& bodies, const BodyJoint& joint) {
  const auto is = [](const Body& body) { return body.is_link || body.continuous; };
  return is(bodies[joint.a]) || is(bodies[joint.b]);
}

void add_rows(BodyJoint& joint, std::uint32_t index, const RowEnd& a, const RowEnd& b,
              const RowJointStep& step, std::vector<solve::JointRow>& rows,
              std::vector<solve::JointPair>& pairs) {
  if (joint.rows_sub_step != step.h) build_rows(joint, step.h);
  joint.rows_sub_step = step.h;
  // speeds: the rate of each residual. curves: by how much its mean rate over the step exceeds
  // that.
  JointEvaluation measure, next;
  double speeds[solve::kJointRows] = {}, curves[solve::kJointRows] = {};
  evaluate(joint, a.now, b.now, measure);
  if (step.of == RowsOf::first_instant) {
    const double rotated[2] = {joint.rotated[0], joint.rotated[1]};
    evaluate(joint, a.next, b.next, next);
    std::copy_n(rotated, 2, joint.rotated);
  }
  for (int i = 0; i < joint.count; ++i) {
    const RowJacobian& J = measure.jacobian[i];
    speeds[i] = dot(J.linear_a, a.velocity.v) + dot(J.angular_a, a.velocity.w) +
                dot(J.linear_b, b.velocity.v) + dot(J.angular_b, b.velocity.w);
    if (step.of != RowsOf::first_instant) continue;
    curves[i] = (next.residual[i] - measure.residual[i]) / step.h - speeds[i];
  }
  const bool user = joint.spec.form == JointSpec::Form::user;
  const Vec3 anchor = user ? Vec3{} : b.now.T * joint.T_b_joint.position() - b.now.centre;
  RowsOfJoint added(joint, index, step, anchor, measure, speeds, curves, rows, pairs);
  for (int i = 0; i < joint.count; ++i) added.add(i);
  if (!step.with_memory()) return;
  joint.forget_impulses();
}

void take_back(std::span<const solve::JointRow> rows, std::span<const solve::JointPair> pairs,
               const RowJointStep& step, double dt, Joints& joints) {
  for (const solve::JointRow& row : rows) {
    if (row.pair == solve::kNoPair) continue;
    const solve::JointPair& pair = pairs[row.pair];
    BodyJoint& joint = joints[pair.joint];
    const double full_impulse = row.impulse / step.fraction;
    const Vec3 force = (row.impulse / dt) * pair.b.linear;
    const Vec3 torque = (row.impulse / dt) * (pair.b.angular - cross(pair.anchor, pair.b.linear));
    if (!in_range(full_impulse) || !in_range(force) || !in_range(torque)) continue;
    joint.force += force;
    joint.torque += torque;
    if (!step.with_memory()) continue;
    (pair.of_stop ? joint.stop : joint.impulse)[pair.row] += full_impulse;
  }
}

bool is_far_open(const BodyJoint& joint, const BodyPose& a, const BodyPose& b, double size) {
  if (joint.spec.form != JointSpec::Form::axes && joint.spec.form != JointSpec::Form::distance)
    return false;
  for (int i = 0; i < joint.locked; ++i) {
    const BodyJointRow& row = joint.rows[i];
    if (!row.relaxes) continue;
    const double error = std::fabs(coordinate(joint, a, b, row.slot).value_or(0.0) - row.position);
    if (error > (is_angle(joint, row) ? kRotationError : kMaxJointSeparation * size)) return true;
  }
  return false;
}

}  // namespace vp
