// Sixteen joints between bodies in structure-of-arrays layout, each with up to six rows that are
// solved together.
//
// With J the rows (the derivative of each residual by both bodies' velocities), M the bodies'
// masses, C the residuals, p the impulses so far, h the sub-step, locked rows solve
//
//   J (v + M^-1 J^T d) = -rate C - G (p + d),   rate and G: a stiff spring's and damper's over h
//
// and bounded rows (drives and limits) their force laws within bounds. A block eliminates the
// locked rows from K = J M^-1 J^T + G by L D L^T. The remaining Schur complement is the response of
// the bounded rows while the locked rows are satisfied. The bounded rows are solved in sequence,
// then the locked rows by back substitution.
//
// All joints of a block have the same rows in the same order: first the three of a locked point,
// along the world's axes, then other locked rows, then bounded ones. No body that an impulse
// moves is in two slots of a block. The contents of a block are those of one step: its impulses
// come from the world's joints and are written back to them.
//
// Source: Catto, Soft Constraints, GDC 2011; Golub and Van Loan, Matrix Computations, 4.1.
#pragma once

#include <array>
#include <cstdint>
#include <type_traits>

#include "solve/field.h"

namespace vphysics_solver {

inline constexpr int kJointRows = 6;
// Of hard rows: the fraction of an error that a sub-step corrects, and G as a fraction of K.
inline constexpr double kJointBias = 0.2, kJointLoss = 0.05;
inline constexpr float kNoBound = 1e30f;        // an absent limit
inline constexpr float kMaxAngularBias = 3.0f;  // maximum bias velocity of angular rows [rad/s]

// What a row measures: slots 0 to 5 are those of JointAxis; the first three are displacements along
// a's axes.
inline constexpr std::uint8_t kSwingX = 3, kSwingY = 4, kTwist = 5, kCone = 6;

struct JointForm {
  std::uint8_t rows = 0;    // not counting those of a point
  std::uint8_t locked = 0;  // the number of locked rows; they come first
  std::uint8_t slot[kJointRows] = {};
  bool operator==(const JointForm&) const = default;
  bool has(std::uint8_t target) const {
    for (int i = 0; i < rows; ++i) {
      if (slot[i] == target) return true;
    }
    return false;
  }
};

// A point of b in a's frame, and the rows that lock it.
struct PointPart {
  Field3 start_arm_a, start_arm_b,
      start_separation;  // at the start of the step; the separation is p_b - p_a [m]
  Field3 arm_a, arm_b;   // from the centres of mass to p_b, where both forces act
  Field3 impulse;
  Field rate, loss, relaxes;  // as in RowPart
};
// Reference for angular rows: axes of the joint's two frames at the start of the step, world frame.
struct AxesPart {
  Field3 a_x, a_y, b_x, b_z;
  Field twist;           // accumulated, without the full revolutions at the start of the step [rad]
  Field cone_x, cone_y;  // the cone's half angles [rad]
};
struct RowPart {
  Field residual;  // C; for a bounded row its coordinate
  Field impulse;   // [N s] or [N m s]: of a locked row or a drive
  // Of locked rows and of limits: the rate at which an error is removed [1/s]; G as a fraction of
  // K_ii; 1 if the row is relaxed. Rows with user-defined softness are not relaxed.
  Field rate, loss, relaxes;
};
struct BoundPart {
  Field stop;   // impulse of the limits: >= 0 at the lower one, <= 0 at the upper
  Field holds;  // 1: behaves as a locked row, but within impulse bounds
  Field min_impulse, max_impulse;  // of a row locked within bounds, or a drive [N s]
  // Of a drive: impulse = h (stiffness (position - q) + damping (speed - q')), within its bounds.
  Field stiffness, damping, position, speed;
  Field lower, upper;  // of the coordinate
};
// The derivative of a residual by the velocities of the centres of mass and the angular velocities,
// world axes.
struct TwelvePart {
  Field3 linear_a, angular_a, linear_b, angular_b;
};
template <int>
struct NoPart {};
// An array that may have no elements, and no size then: that of the standard library has one.
template <class T>
struct NoElements {
  T& operator[](int) const { __builtin_unreachable(); }
};
template <class T, int kCount>
using SomeOf =
    std::conditional_t<kCount == 0, NoElements<T>, std::array<T, static_cast<std::size_t>(kCount)>>;

// kPoint: 3 or 0, the rows of a locked point. kOthers: the maximum number of other rows. Their
// Jacobians are along and about axes that the passes compute (kOfAxes), or are given by the caller.
template <int kPoint, int kOthers, bool kOfAxes>
struct JointBlock {
  static constexpr int kPointRows = kPoint, kOtherRows = kOthers, kAll = kPoint + kOthers;
  static constexpr bool kAxes = kOfAxes;

  IndexField a, b;                 // indices of the bodies' states; kWorldState in an empty slot
  IndexField joint;                // index in the world's joints
  FieldSym3 inertia_a, inertia_b;  // inverse, as are the masses
  Field mass_a, mass_b;
  Field active;  // 0: the last iteration has hardly changed its impulses
  Field3 force;  // on b: impulses accumulated over the sub-steps so far
  // Not of a point alone: the same about b's anchor.
  [[no_unique_address]] std::conditional_t<kOthers != 0, Field3, NoPart<3>> torque;
  // For Jacobians given by the caller: from b's centre of mass.
  [[no_unique_address]] std::conditional_t<kOfAxes, NoPart<2>, Field3> anchor;
  [[no_unique_address]] std::conditional_t<kOfAxes, PointPart, NoPart<0>> point;
  [[no_unique_address]] std::conditional_t<kOfAxes && kOthers != 0, AxesPart, NoPart<1>> axes;
  // Of all rows, prepared in each sub-step: rate C, of a drive C - position; K_ii without G.
  Field bias[kAll], own[kAll];
  Field factor[kAll * (kAll + 1) / 2];  // L below the diagonal; 1 / D on it
  [[no_unique_address]] SomeOf<RowPart, kOthers> rows;
  [[no_unique_address]] SomeOf<BoundPart, kOthers> bounds;
  [[no_unique_address]] SomeOf<std::conditional_t<kOfAxes, Field3, TwelvePart>, kOthers> jacobian;
};
using BallBlock = JointBlock<3, 0, true>;
using AxesBlock = JointBlock<3, 3, true>;            // a point and angular rows
using FrameBlock = JointBlock<0, kJointRows, true>;  // any of the six coordinates
using RowsBlock = JointBlock<0, kJointRows, false>;

// Motion of a body since the start of the step: a unit quaternion x y z w, a displacement [m].
struct alignas(32) StepMotion {
  float rotation[4];
  float displacement[3];
  float unused;
};

}  // namespace vphysics_solver

namespace vp::solve {
using namespace vphysics_solver;  // NOLINT(google-build-using-namespace): see passes.h
}  // namespace vp::solve
