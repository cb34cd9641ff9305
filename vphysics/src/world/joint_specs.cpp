// The rows of each kind of joint, and the checks of their descriptions.
#include <algorithm>
#include <cmath>
#include <type_traits>

#include "world/joint.h"
#include "world/validate.h"

namespace vp {
namespace {

// For rows that are almost free; times K it stays finite in single precision.
constexpr double kMaxLoss = 1e9;

AxisDesc axis(AxisMotion motion, double lower = 0.0, double upper = 0.0, JointDrive drive = {}) {
  return {motion, lower, upper, drive};
}
AxisDesc free_or_limited(double lower, double upper, const JointDrive& drive) {
  const bool free = lower == -kNoLimit && upper == kNoLimit;
  return axis(free ? AxisMotion::free : AxisMotion::limited, lower, upper, drive);
}
void lock(JointSpec& spec, int first, int last) {
  for (int i = first; i <= last; ++i) spec.axes[i].motion = AxisMotion::locked;
}

void fill(JointSpec& spec, const BallSocket&) {
  lock(spec, 0, 2);
}
void fill(JointSpec& spec, const Hinge& hinge) {
  lock(spec, 0, 4);
  spec.axes[5] = free_or_limited(hinge.lower, hinge.upper, hinge.drive);
}
void fill(JointSpec& spec, const Slider& slider) {
  lock(spec, 0, 5);
  spec.axes[2] = free_or_limited(slider.lower, slider.upper, slider.drive);
}
void fill(JointSpec& spec, const Weld&) {
  lock(spec, 0, 5);
}
void fill(JointSpec& spec, const Distance& distance) {
  spec.form = JointSpec::Form::distance;
  const bool rod = distance.min == distance.max;
  spec.axes[0] = axis(rod ? AxisMotion::locked : AxisMotion::limited, distance.min, distance.max);
}
void fill(JointSpec& spec, const Spring& spring) {
  spec.form = JointSpec::Form::distance;
  spec.axes[0].drive = {spring.length, 0.0, spring.stiffness, spring.damping, kNoLimit};
}
void fill(JointSpec& spec, const ConeTwist& cone) {
  lock(spec, 0, 2);
  spec.cone = true;
  spec.swing_x = cone.swing_x;
  spec.swing_y = cone.swing_y;
  spec.axes[5] = free_or_limited(cone.lower, cone.upper, cone.drive);
}
void fill(JointSpec& spec, const SixDof& six) {
  for (int i = 0; i < 6; ++i) spec.axes[i] = six.axes[i];
}
void fill(JointSpec& spec, const Gear& gear) {
  spec.form = JointSpec::Form::gear;
  spec.axes[0].motion = AxisMotion::locked;
  spec.ratio = gear.ratio;
  spec.slides_a = gear.slides_a;
  spec.slides_b = gear.slides_b;
}
void fill(JointSpec& spec, const UserConstraint& user) {
  spec.form = JointSpec::Form::user;
  spec.user = user.constraint;
  spec.user_rows = user.constraint->rows();
  for (int i = 0; i < spec.user_rows; ++i) spec.user_row_descs[i] = user.constraint->row_desc(i);
}

// Rate and loss of a spring of frequency f against the mass of the row alone (K), integrated
// implicitly.
void soften(BodyJointRow& row, double frequency, double damping_ratio, double h) {
  if (frequency == 0.0) {
    row.rate = solve::kJointBias / h;
    row.loss = solve::kJointLoss;
    row.relaxes = true;
    return;
  }
  const double omega = 2.0 * kPi * frequency, both = 2.0 * damping_ratio + h * omega;
  row.rate = omega / both;
  row.loss = std::min(1.0 / (h * omega * both), kMaxLoss);
  row.relaxes = false;
}

BodyJointRow locked_row(int slot) {
  BodyJointRow row;
  row.slot = static_cast<std::uint8_t>(slot);
  return row;
}
void set_drive(BodyJointRow& row, const JointDrive& drive, double h) {
  row.max_impulse = std::min(h * drive.max_force, BodyJointRow::kNoBound);
  row.min_impulse = -row.max_impulse;
  row.stiffness = drive.stiffness;
  row.damping = drive.damping;
  row.position = drive.position;
  row.speed = drive.velocity;
}

struct Rows {
  BodyJointRow rows[solve::kJointRows];
  int count = 0, locked = 0;
  void add(const BodyJointRow& row, bool is_locked) {
    if (is_locked) {
      for (int i = count; i > locked; --i) rows[i] = rows[i - 1];
      rows[locked++] = row;
    } else {
      rows[count] = row;
    }
    ++count;
  }
};

bool has_drive(const AxisDesc& desc) {
  return desc.drive.max_force > 0.0;
}

Rows rows_of_axes(const JointSpec& spec, double h) {
  Rows out;
  const int axes = spec.form == JointSpec::Form::axes ? 6 : 1;
  for (int i = 0; i < axes; ++i) {
    const AxisDesc& desc = spec.axes[i];
    const bool of_cone = spec.cone && i == static_cast<int>(JointAxis::rotation_x);
    if (desc.motion == AxisMotion::free && !has_drive(desc) && !of_cone) continue;
    BodyJointRow row = locked_row(i);
    const bool locked = desc.motion == AxisMotion::locked;
    if (locked) {
      row.position = desc.lower;  // of a rod
    } else {
      set_drive(row, desc.drive, h);
      if (desc.motion == AxisMotion::limited) {
        row.lower = std::max(desc.lower, -BodyJointRow::kNoBound);
        row.upper = std::min(desc.upper, BodyJointRow::kNoBound);
      }
      if (of_cone) row.lower = 0.0;
    }
    out.add(row, locked);
  }
  return out;
}

Rows rows_of_user(const JointSpec& spec, double h) {
  Rows out;
  for (int i = 0; i < spec.user_rows; ++i) {
    const ConstraintRowDesc& own = spec.user_row_descs[i];
    BodyJointRow row = locked_row(i);
    const bool locked = own.min_force == -kNoLimit && own.max_force == kNoLimit;
    row.bounded_hold = !locked;
    row.min_impulse = std::max(h * own.min_force, -BodyJointRow::kNoBound);
    row.max_impulse = std::min(h * own.max_force, BodyJointRow::kNoBound);
    out.add(row, locked);
  }
  return out;
}

constexpr const char* kFinite = " must be finite and at most 1e9 in magnitude";

std::optional<std::string> problem_with_limits(double lower, double upper) {
  const bool sane = lower <= upper && lower < kLargest && upper > -kLargest &&
                    (in_range(lower) || lower == -kNoLimit) &&
                    (in_range(upper) || upper == kNoLimit);
  if (sane) return std::nullopt;
  return "limits: lower must not be above upper, each within 1e9 or infinite on its own side";
}
bool is_valid_gain(double x) {
  return x >= 0.0 && x <= 1e15;
}
std::optional<std::string> problem_with_axis(double lower, double upper, const JointDrive& drive) {
  if (auto problem = problem_with_limits(lower, upper)) return problem;
  return problem_with(drive);
}

std::optional<std::string> problem_in(const BallSocket&) {
  return std::nullopt;
}
std::optional<std::string> problem_in(const Weld&) {
  return std::nullopt;
}
std::optional<std::string> problem_in(const Hinge& hinge) {
  return problem_with_axis(hinge.lower, hinge.upper, hinge.drive);
}
std::optional<std::string> problem_in(const Slider& slider) {
  return problem_with_axis(slider.lower, slider.upper, slider.drive);
}
std::optional<std::string> problem_in(const Distance& distance) {
  const double max = distance.max;
  if (distance.min >= 0.0 && distance.min <= max && in_range(distance.min) &&
      (in_range(max) || max == kNoLimit) && max > 0.0)
    return std::nullopt;
  return "distance: min must be zero or more, max positive and not below it";
}
std::optional<std::string> problem_in(const Spring& spring) {
  if (!in_range(spring.length) || spring.length < 0.0)
    return "spring: the length must be zero or more and at most 1e9";
  if (!is_valid_gain(spring.stiffness) || !is_valid_gain(spring.damping))
    return "spring: stiffness and damping must be zero or more and at most 1e15";
  return std::nullopt;
}
std::optional<std::string> problem_in(const ConeTwist& cone) {
  const auto swing = [](double x) { return x > 0.0 && x <= 3.1; };
  if (!swing(cone.swing_x) || !swing(cone.swing_y))
    return "cone and twist: both swings must be above 0 and at most 3.1 radians";
  return problem_with_axis(cone.lower, cone.upper, cone.drive);
}
std::optional<std::string> problem_in(const SixDof& six) {
  for (const AxisDesc& desc : six.axes) {
    if (desc.motion > AxisMotion::locked) return "axis: motion must be free, limited or locked";
    if (desc.motion == AxisMotion::locked) {
      if (has_drive(desc)) return "axis: what is locked cannot be driven; leave its drive empty";
      continue;
    }
    const bool limited = desc.motion == AxisMotion::limited;
    if (auto problem =
            problem_with_axis(limited ? desc.lower : 0.0, limited ? desc.upper : 0.0, desc.drive))
      return problem;
  }
  for (const int i : {3, 4}) {
    const AxisDesc& desc = six.axes[i];
    if (desc.motion == AxisMotion::limited && (desc.lower < -kPi || desc.upper > kPi))
      return "axis: limits of rotation_x and rotation_y must lie within half a turn";
  }
  return std::nullopt;
}
std::optional<std::string> problem_in(const Gear& gear) {
  if (in_range(gear.ratio) && std::fabs(gear.ratio) >= 1e-9) return std::nullopt;
  return "gear: the ratio must not be zero, and at most 1e9 in magnitude";
}
std::optional<std::string> problem_in(const UserConstraint& user) {
  if (!user.constraint) return "constraint: the pointer is null; give one";
  const int rows = user.constraint->rows();
  if (rows < 1 || rows > solve::kJointRows) return "constraint: it must have 1 to 6 rows";
  for (int i = 0; i < rows; ++i) {
    const ConstraintRowDesc spec = user.constraint->row_desc(i);
    if (!in_range(spec.frequency) || spec.frequency < 0.0 || !in_range(spec.damping_ratio) ||
        spec.damping_ratio < 0.0)
      return "constraint: a row's frequency and damping ratio must be zero or more and finite";
    if (!(spec.min_force <= 0.0 && spec.max_force >= 0.0))
      return "constraint: a row's bounds must have zero between them";
  }
  return std::nullopt;
}

solve::JointForm form_of(const BodyJoint& joint) {
  solve::JointForm form;
  const int point = joint.holds_point() ? 3 : 0;
  form.rows = static_cast<std::uint8_t>(joint.count - point);
  form.locked = static_cast<std::uint8_t>(joint.locked - point);
  if (joint.spec.form != JointSpec::Form::axes) return form;
  for (int i = 0; i < form.rows; ++i) {
    const BodyJointRow& row = joint.rows[point + i];
    const bool of_cone = joint.spec.cone && row.slot == solve::kSwingX;
    form.slot[i] = of_cone ? solve::kCone : row.slot;
  }
  return form;
}
JointBlockKind block_of(const BodyJoint& joint) {
  if (joint.spec.form != JointSpec::Form::axes) return JointBlockKind::rows;
  if (!joint.holds_point()) return JointBlockKind::frames;
  return joint.form.rows == 0 ? JointBlockKind::ball : JointBlockKind::axes;
}

}  // namespace

ConstraintRowDesc PairConstraint::row_desc(int) const {
  return {};
}

JointSpec spec_of(const JointKind& kind) {
  JointSpec spec;
  std::visit([&](const auto& k) { fill(spec, k); }, kind);
  return spec;
}
bool locks_rotation(const JointSpec& spec) {
  if (spec.form == JointSpec::Form::distance) return false;
  if (spec.form != JointSpec::Form::axes) return true;
  return std::any_of(spec.axes + 3, spec.axes + 6,
                     [](const AxisDesc& axis) { return axis.motion == AxisMotion::locked; });
}

double first_rotation(const JointSpec& spec) {
  const AxisDesc& twist = spec.axes[static_cast<int>(JointAxis::rotation_z)];
  if (spec.form != JointSpec::Form::axes || twist.motion != AxisMotion::limited) return 0.0;
  if (!(twist.lower > -kNoLimit)) return std::min(0.0, twist.upper);
  if (!(twist.upper < kNoLimit)) return std::max(0.0, twist.lower);
  return 0.5 * (twist.lower + twist.upper);
}

int main_slot(const JointKind& kind) {
  if (std::holds_alternative<Hinge>(kind) || std::holds_alternative<ConeTwist>(kind)) return 5;
  if (std::holds_alternative<Slider>(kind)) return 2;
  if (std::holds_alternative<Distance>(kind) || std::holds_alternative<Spring>(kind) ||
      std::holds_alternative<Gear>(kind))
    return 0;
  return -1;
}

void build_rows(BodyJoint& joint, double h) {
  const bool user = joint.spec.form == JointSpec::Form::user;
  Rows laid = user ? rows_of_user(joint.spec, h) : rows_of_axes(joint.spec, h);
  double impulse[solve::kJointRows] = {}, stop[solve::kJointRows] = {};
  for (int i = 0; i < laid.count; ++i) {
    BodyJointRow& row = laid.rows[i];
    if (user) {
      const ConstraintRowDesc& own = joint.spec.user_row_descs[row.slot];
      soften(row, own.frequency, own.damping_ratio, h);
    } else {
      soften(row, joint.frequency, joint.damping_ratio, h);
    }
    for (int k = 0; k < joint.count; ++k) {
      if (joint.rows[k].slot != row.slot) continue;
      impulse[i] = joint.impulse[k];
      stop[i] = joint.stop[k];
    }
  }
  std::copy_n(laid.rows, laid.count, joint.rows);
  std::copy_n(impulse, solve::kJointRows, joint.impulse);
  std::copy_n(stop, solve::kJointRows, joint.stop);
  joint.count = laid.count;
  joint.locked = laid.locked;
  joint.form = form_of(joint);
  joint.block = block_of(joint);
}

std::optional<std::string> problem_with(const JointDesc& desc) {
  if (!is_pose(desc.T_a_joint) || !is_pose(desc.T_b_joint))
    return "T_a_joint and T_b_joint must be finite rotations and positions";
  if (!in_range(desc.frequency) || desc.frequency < 0.0)
    return std::string("frequency must be zero or more and") + kFinite;
  if (!in_range(desc.damping_ratio) || desc.damping_ratio < 0.0)
    return std::string("damping_ratio must be zero or more and") + kFinite;
  return std::visit([](const auto& kind) { return problem_in(kind); }, desc.kind);
}

}  // namespace vp
