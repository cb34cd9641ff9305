// Joints of links and of continuous bodies. They have rows of their own (solve/joint_row.h), in
// double precision, and are solved together with the contacts of these bodies. All other joints are
// in blocks (joint_steps.h).
//
// Such a joint is solved where the contacts of its bodies would be: in the sub-steps, if a link
// moves together with a body that is in them; else at each instant of the impact stage. There,
// velocities satisfy hard constraints exactly along the chord of the step's motion, so that a
// swinging body loses no energy. A position correction removes the remaining error. In sub-steps
// the constraints are solved as in blocks.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "solve/joint_row.h"
#include "world/joint.h"

namespace vp {

bool is_in_rows(const Bodies& bodies, const BodyJoint& joint);

enum class RowsOf : std::uint8_t { sub_step, first_instant, impact };

struct RowJointStep {
  RowsOf of;
  double h;           // duration that the rows' impulses are of [s]
  double left;        // remaining time of the step [s]
  double fraction;    // h as a fraction of the step
  double speed_unit;  // scale of speeds: square root of length_unit

  // Rows warm start from the last step and are remembered. Springs and drives act over time, so
  // they do not act in an impact.
  bool with_memory() const { return of != RowsOf::impact; }
};

// The body at one end: its current pose, the velocity of its reference point, and the pose to which
// that leads at the end of the step.
struct RowEnd {
  BodyPose now;
  Velocity velocity;
  BodyPose next;
};

// Appends the rows of one joint.
void add_rows(BodyJoint& joint, std::uint32_t index, const RowEnd& a, const RowEnd& b,
              const RowJointStep& step, std::vector<solve::JointRow>& rows,
              std::vector<solve::JointPair>& pairs);
// Takes the solved impulses back: stores them for the next step, and adds to the joint's mean force
// over a step dt.
void take_back(std::span<const solve::JointRow> rows, std::span<const solve::JointPair> pairs,
               const RowJointStep& step, double dt, Joints& joints);
// Whether a hard constraint is far open (JointSteps::is_far_open).
bool is_far_open(const BodyJoint& joint, const BodyPose& a, const BodyPose& b, double size);

}  // namespace vp
