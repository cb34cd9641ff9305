// A joint between two bodies, as the world keeps it.
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "solve/joint_block.h"
#include "vphysics/lie.h"
#include "vphysics/world.h"
#include "world/body.h"
#include "world/slots.h"

namespace vp {

// Where a body is within a step.
struct BodyPose {
  SE3 T;
  Vec3 centre;  // reference point, world frame
};
inline BodyPose pose_of(const Body& body) {
  return {body.T, reference_point(body)};
}

// What all kinds are made into.
struct JointSpec {
  enum class Form : std::uint8_t { axes, distance, gear, user };
  Form form = Form::axes;
  AxisDesc axes[6];  // of a distance and a gear the first
  bool cone = false;
  double swing_x = 0.0, swing_y = 0.0;
  double ratio = 0.0;
  bool slides_a = false, slides_b = false;
  std::shared_ptr<const PairConstraint> user;
  ConstraintRowDesc user_row_descs[6];
  int user_rows = 0;
};
JointSpec spec_of(const JointKind& kind);

// A row of a joint: its law for sub-steps of one length, and its impulses, which are state. See
// solve/joint_block.h for what each is.
struct BodyJointRow {
  std::uint8_t slot = 0;  // which of the joint's coordinates it is of
  double impulse = 0.0, stop = 0.0;
  double rate = 0.0, loss = 0.0;
  bool relaxes = true;
  bool bounded_hold = false;
  double min_impulse = 0.0, max_impulse = 0.0;
  double stiffness = 0.0, damping = 0.0, position = 0.0, speed = 0.0;
  double lower = -kNowhere, upper = kNowhere;

  static constexpr double kNowhere = static_cast<double>(solve::kNowhere);
};

// The derivative of a residual by velocities of the centres of mass and angular velocities, world
// axes.
struct Twelve {
  Vec3 linear_a, angular_a, linear_b, angular_b;
};
// What rows are, where the bodies are.
struct JointMeasure {
  Twelve jacobian[solve::kJointRows];
  double residual[solve::kJointRows] = {};
};

struct BodyJoint {
  std::uint32_t generation = 0;
  bool alive = false;
  std::uint32_t a = 0, b = 0;  // bodies
  // Neighbours in the lists of the bodies; an edge is 2 * joint + side.
  std::uint32_t next[2] = {}, previous[2] = {};
  bool collide = false;
  bool in_rows = false;  // row_joints.h
  SE3 T_a_joint, T_b_joint;
  double frequency = 0.0, damping_ratio = 1.0;
  JointSpec spec;  // its drives are state
  int main = -1;   // slot of its one coordinate
  // Angles counted on beyond whole turns: of the twist; of a gear's two bodies.
  double rotated[2] = {};
  SE3 start[2];  // of a gear: the bodies' poses at its creation
  // The first `held` are held; a point's impulse is that of the slots 0 to 2, along the world's
  // axes.
  BodyJointRow rows[solve::kJointRows];
  int count = 0, locked = 0;
  double laid_out_for = 0.0;  // the sub-step of the rows; 0: they must be laid out
  Vec3 force, torque;         // of the last step

  bool holds_point() const {
    return spec.form == JointSpec::Form::axes && locked >= 3 && rows[2].slot == 2;
  }
};

using Joints = Slots<BodyJoint, JointId>;

// Of two dynamic bodies of which the one, no link, is continuous or not.
inline bool can_be_joined(bool continuous, const Body& other) {
  return other.is_link || other.continuous == continuous;
}
inline constexpr const char* kNotJoined =
    "a continuous body cannot be joined to a dynamic one that is not; create both with or both "
    "without continuous";

// Into the lists of its bodies.
void link_joint(Bodies& bodies, Joints& joints, std::uint32_t joint);
// Whether a joint keeps the colliders of two bodies from meeting.
bool disables_collision(const Bodies& bodies, const Joints& joints, std::uint32_t a,
                        std::uint32_t b);
// What a body's joints have to start from is no good.
void forget_joints(const Body& body, Joints& joints);

// The rows that the joint has, their laws for sub-steps h, impulses kept where the coordinate is.
void lay_out(BodyJoint& joint, double h);
// Jacobians and residuals of all rows where the bodies are; turns are counted on.
void evaluate(BodyJoint& joint, const BodyPose& a, const BodyPose& b, JointMeasure& out);
// Counts a twist on to what it is there.
void count_revolutions(BodyJoint& joint, const BodyPose& a, const BodyPose& b);
// One coordinate; nothing if the joint has none such.
std::optional<double> coordinate(const BodyJoint& joint, const BodyPose& a, const BodyPose& b,
                                 int slot);
// Where the count of whole turns of a twist begins: within its limits.
double first_rotation(const JointSpec& spec);
// The slot of the one coordinate, or -1.
int main_slot(const JointKind& kind);

std::optional<std::string> problem_with(const JointDesc& desc);

}  // namespace vp
