// A joint between two bodies, as the world stores it.
#pragma once

#include <algorithm>
#include <cstdint>
#include <iterator>
#include <optional>
#include <string>

#include "solve/joint_block.h"
#include "vphysics/lie.h"
#include "vphysics/world.h"
#include "world/body.h"
#include "world/slots.h"

namespace vp {

// The pose of a body within a step.
struct BodyPose {
  SE3 T;
  Vec3 centre;  // reference point, world frame
};
inline BodyPose pose_of(const Body& body) {
  return {body.T, reference_point(body)};
}

// The common form of all kinds of joints.
struct JointSpec {
  enum class Form : std::uint8_t { axes, distance, gear, user };
  Form form = Form::axes;
  AxisDesc axes[6];  // of a distance and a gear only the first
  bool cone = false;
  double swing_x = 0.0, swing_y = 0.0;
  double ratio = 0.0;
  bool slides_a = false, slides_b = false;
  std::shared_ptr<const PairConstraint> user;
  ConstraintRowDesc user_row_descs[6];
  int user_rows = 0;
};
JointSpec spec_of(const JointKind& kind);
// Whether it locks a rotation. A gear couples two, a user's constraint may.
bool locks_rotation(const JointSpec& spec);

// A row of a joint: its force law for one sub-step length. solve/joint_block.h describes the
// fields.
struct BodyJointRow {
  double rate = 0.0, loss = 0.0;
  std::uint8_t slot = 0;  // index of the joint's coordinate
  bool relaxes = true;
  bool bounded_hold = false;
  double min_impulse = 0.0, max_impulse = 0.0;
  double stiffness = 0.0, damping = 0.0, position = 0.0, speed = 0.0;
  double lower = -kNoBound, upper = kNoBound;

  static constexpr double kNoBound = static_cast<double>(solve::kNoBound);
};

// The derivative of a residual by the velocities of the centres of mass and the angular velocities,
// world axes.
struct RowJacobian {
  Vec3 linear_a, angular_a, linear_b, angular_b;
};
// Jacobian and residual of each row, at given poses.
struct JointEvaluation {
  RowJacobian jacobian[solve::kJointRows];
  double residual[solve::kJointRows] = {};
};

// The kind of block that a joint is solved in (solve/joint_block.h).
enum class JointBlockKind : std::uint8_t { ball, axes, frames, rows };
inline constexpr int kJointBlockKinds = 4;

// A step reads the fields in their order, as far as the joint's rows go.
struct BodyJoint {
  std::uint32_t generation = 0;
  bool alive = false;
  bool collide = false;
  bool in_rows = false;  // row_joints.h
  JointBlockKind block = JointBlockKind::rows;
  std::uint32_t a = 0, b = 0;  // bodies
  // Neighbours in the joint lists of the bodies. An edge is 2 * joint + side.
  std::uint32_t next[2] = {}, previous[2] = {};
  solve::JointForm form;  // of its rows
  // The first `locked` rows are locked. In a joint with a locked point, rows 0 to 2 have the
  // point's impulse along the world's axes.
  int count = 0, locked = 0;
  double rows_sub_step = 0.0;  // the sub-step length of the rows; 0: the rows must be laid out
  Vec3 force, torque;          // of the last step
  double impulse[solve::kJointRows] = {}, stop[solve::kJointRows] = {};  // of each row: state
  SE3 T_a_joint, T_b_joint;
  // Angles that count full revolutions: the twist; of a gear, one for each body.
  double rotated[2] = {};
  BodyJointRow rows[solve::kJointRows];
  double frequency = 0.0, damping_ratio = 1.0;
  int main = -1;   // slot of its main coordinate; -1: none
  SE3 start[2];    // of a gear: the bodies' poses at its creation
  JointSpec spec;  // its drives are state

  void forget_impulses() {
    std::fill(std::begin(impulse), std::end(impulse), 0.0);
    std::fill(std::begin(stop), std::end(stop), 0.0);
  }
  bool holds_point() const {
    return spec.form == JointSpec::Form::axes && locked >= 3 && rows[2].slot == 2;
  }
};

using Joints = Slots<BodyJoint, JointId>;

// For two dynamic bodies, the first of which is not a link and is continuous or not.
inline bool can_be_joined(bool continuous, const Body& other) {
  return other.is_link || other.continuous == continuous;
}
inline constexpr const char* kNotJoined =
    "a continuous body cannot be joined to a dynamic one that is not; create both with or both "
    "without continuous";

// Adds the joint to the lists of its bodies.
void link_joint(Bodies& bodies, Joints& joints, std::uint32_t joint);
// Whether a joint disables collision between the colliders of two bodies.
bool disables_collision(const Bodies& bodies, const Joints& joints, std::uint32_t a,
                        std::uint32_t b);
// Clears the warm start of a body's joints.
void forget_joints(const Body& body, Joints& joints);

// Builds the joint's rows, with their force laws for sub-steps h. A row keeps the impulses of its
// coordinate.
void build_rows(BodyJoint& joint, double h);
// Jacobians and residuals of all rows at the given poses. Updates the revolution counts.
void evaluate(BodyJoint& joint, const BodyPose& a, const BodyPose& b, JointEvaluation& out);
// Updates the twist to the given poses, counting full revolutions.
void count_revolutions(BodyJoint& joint, const BodyPose& a, const BodyPose& b);
// One coordinate; empty if the joint does not have it.
std::optional<double> coordinate(const BodyJoint& joint, const BodyPose& a, const BodyPose& b,
                                 int slot);
// The initial twist, from which revolutions are counted: within its limits.
double first_rotation(const JointSpec& spec);
// The slot of the main coordinate, or -1.
int main_slot(const JointKind& kind);

std::optional<std::string> problem_with(const JointDesc& desc);

}  // namespace vp
