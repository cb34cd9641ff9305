// Sixteen joints between bodies side by side, each of up to six rows that are solved together.
//
// With J the rows (each residual's rate by both bodies' velocities), M the bodies' masses,
// C the residuals, p the impulses so far, h the sub-step, held rows take
//
//   J (v + M^-1 J^T d) = -rate C - G (p + d),   rate and G: a stiff spring's and damper's over h
//
// and bounded rows (drives and limits) their laws with bounds. A block eliminates the held rows
// from K = J M^-1 J^T + G by L D L^T; what is left, the Schur complement, is what the bounded rows
// feel while the held ones hold. They are gone through in turn, then the held ones follow.
//
// Joints of a block have the same rows, in the same order: first the three of a point that is held,
// along the world's axes, then other held ones, then bounded ones. No body but the fixed world is
// in two lanes of a block. A block lives for a step: its impulses come from the world's joints and
// go back to them.
//
// Source: Catto, Soft Constraints, GDC 2011; Golub and Van Loan, Matrix Computations, 4.1.
#pragma once

#include <cstdint>
#include <type_traits>

#include "solve/field.h"

namespace vphysics_solver {

inline constexpr int kJointRows = 6;
inline constexpr float kNowhere = 1e30f;        // a limit that is not there
inline constexpr float kMaxAngularBias = 3.0f;  // by which velocities take out an error [rad/s]

// What a row measures: slots 0 to 5 are those of JointAxis, the first three ways along a's axes.
inline constexpr std::uint8_t kSwingX = 3, kSwingY = 4, kTwist = 5, kCone = 6;

struct JointForm {
  std::uint8_t rows = 0;    // beside the point's
  std::uint8_t locked = 0;  // of these; they come first
  std::uint8_t slot[kJointRows] = {};
  bool operator==(const JointForm&) const = default;
  bool has(std::uint8_t target) const {
    for (int i = 0; i < rows; ++i) {
      if (slot[i] == target) return true;
    }
    return false;
  }
};

// A point of b as one of a sees it, and what holds it there.
struct PointPart {
  Field3 start_arm_a, start_arm_b,
      start_separation;  // when the step began; the gap is p_b - p_a [m]
  Field3 arm_a, arm_b;   // from the centres of mass to p_b: both forces act there
  Field3 impulse;
  Field rate, loss, relaxes;  // as those of a row
};
// What turning is measured by: axes of the joint's two frames when the step began, world frame.
struct AxesPart {
  Field3 a_x, a_y, b_x, b_z;
  Field twist;           // counted on, but for the whole turns that the step began with [rad]
  Field cone_x, cone_y;  // the cone's half angles [rad]
};
struct RowPart {
  Field residual;  // C; of a bounded row its coordinate
  Field impulse;   // [N s] or [N m s]: of what holds or drives
  // Of what holds and of limits: the rate at which an error is taken out [1/s]; G as a share of
  // K_ii. One that is soft by the user's choice is not relaxed.
  Field rate, loss, relaxes;
};
struct BoundPart {
  Field stop;   // impulse of the limits: >= 0 of the lower one, <= 0 of the upper
  Field holds;  // 1: holds as held rows do, but within bounds
  Field min_impulse, max_impulse;  // of what holds within bounds or drives [N s]
  // Of a drive: impulse = h (stiffness (position - q) + damping (speed - q')), within its bounds.
  Field stiffness, damping, position, speed;
  Field lower, upper;  // of the coordinate
};
// The derivative of a residual by velocities of the centres of mass and angular velocities, world
// axes.
struct TwelvePart {
  Field3 linear_a, angular_a, linear_b, angular_b;
};
template <int>
struct NoPart {};

// kPoint: 3 or 0, rows of a point that is held. kOthers: the most rows beside these. Their
// Jacobians are along and about axes that the passes find (kOfAxes), or come from outside.
template <int kPoint, int kOthers, bool kOfAxes>
struct JointBlock {
  static constexpr int kPointRows = kPoint, kOtherRows = kOthers, kAll = kPoint + kOthers;
  static constexpr bool kAxes = kOfAxes;

  IndexField a, b;   // rows of the bodies; of an empty lane the world's
  IndexField joint;  // index in the world's joints
  FieldSym3 inertia_a, inertia_b;
  Field active;          // 0: the last round of pushing has hardly changed its impulses
  Field3 force, torque;  // on b, about its anchor, of the sub-steps so far, added up
  Field3 anchor;         // of what comes from outside: from b's centre of mass
  [[no_unique_address]] std::conditional_t<kOfAxes, PointPart, NoPart<0>> point;
  [[no_unique_address]] std::conditional_t<kOfAxes && kOthers != 0, AxesPart, NoPart<1>> axes;
  // Of all rows, prepared in each sub-step: rate C; G; K_ii without it.
  Field bias[kAll], leak[kAll], own[kAll];
  Field factor[kAll * (kAll + 1) / 2];  // below the diagonal L; on it 1 / D
  RowPart rows[kOthers > 0 ? kOthers : 1];
  BoundPart bounds[kOthers > 0 ? kOthers : 1];
  std::conditional_t<kOfAxes, Field3, TwelvePart> jacobian[kOthers > 0 ? kOthers : 1];
};
using BallBlock = JointBlock<3, 0, true>;
using AxesBlock = JointBlock<3, 3, true>;            // a point and what turns
using FrameBlock = JointBlock<0, kJointRows, true>;  // any of the six coordinates
using RowsBlock = JointBlock<0, kJointRows, false>;

// How a body has turned and moved since the step began: a unit quaternion x y z w, a way [m].
struct alignas(32) Gone {
  float rotation[4];
  float displacement[3];
  float unused;
};

}  // namespace vphysics_solver

namespace vp::solve {
using namespace vphysics_solver;  // NOLINT(google-build-using-namespace): see passes.h
}  // namespace vp::solve
