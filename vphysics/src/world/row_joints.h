// Joints that are solved with the contacts of links and of continuous bodies: in rows of their own
// (solve/joint_row.h), in double precision. All others are in lanes (joint_steps.h).
//
// One of which an end is a link or continuous is solved where its contacts would be: in the
// sub-steps, where a link moves with a body that has them, else at each instant of the stage of
// impacts. What holds hard is there held exactly by velocities, along the chord of where the step
// leads, so that what swings loses nothing; what error is left is taken out by moving the bodies.
// In sub-steps it is held as in lanes.
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
  double h;           // that the rows' impulses are of [s]
  double left;        // to the end of the step [s]
  double fraction;    // h as a share of the step
  double speed_unit;  // what a speed of things of a metre counts

  // Rows start from what they were in the last step, and are remembered. Springs and drives take
  // time: what happens at once does not feel them.
  bool with_memory() const { return of != RowsOf::impact; }
};

// A body at one end: where it is now, how its reference point moves, and where that would take it
// by the end of the step.
struct RowEnd {
  BodyPose now;
  Velocity velocity;
  BodyPose next;
};

// The rows of one joint at the end of those there are.
void add_rows(BodyJoint& joint, std::uint32_t index, const RowEnd& a, const RowEnd& b,
              const RowJointStep& step, std::vector<solve::JointRow>& rows,
              std::vector<solve::JointPair>& pairs);
// What has been solved: to be remembered, and to the joint's mean force over a step dt.
void take_back(std::span<const solve::JointRow> rows, std::span<const solve::JointPair> pairs,
               const RowJointStep& step, double dt, Joints& joints);
// Whether what it holds hard is open by much (JointSteps::is_far_open).
bool is_far_open(const BodyJoint& joint, const BodyPose& a, const BodyPose& b, double size);

}  // namespace vp
