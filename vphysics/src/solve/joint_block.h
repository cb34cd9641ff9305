// A joint between two bodies as the sub-stepped solver sees it: up to six rows, solved together.
//
// With J the rows (each residual's rate by both bodies' velocities), M the bodies' masses,
// C the residuals, p the impulses so far, h the sub-step, held rows take
//
//   J (v + M^-1 J^T d) = -rate C - G (p + d),   rate and G: a stiff spring's and damper's over h
//
// and bounded rows (drives and limits) their laws with bounds. The block eliminates the held rows
// from K = J M^-1 J^T + G by L D L^T; what is left, the Schur complement, is what the bounded rows
// feel while the held ones hold. They are gone through in turn, then the held ones follow.
//
// Source: Catto, Soft Constraints, GDC 2011; Golub and Van Loan, Matrix Computations, 4.1.
#pragma once

#include <cstdint>

#include "solve/body_row.h"
#include "vphysics/lie/inertia.h"
#include "vphysics/lie/vec3.h"

namespace vp::solve {

inline constexpr int kJointRows = 6;
inline constexpr double kNowhere = 1e30;  // a limit that is not there

// The derivative of a residual by velocities of the centres of mass and angular velocities, world
// axes.
struct Twelve {
  Vec3 linear_a, angular_a, linear_b, angular_b;
};

struct JointRow6 {
  Twelve jacobian;
  Twelve answer;          // M^-1 J^T
  double own = 0.0;       // J M^-1 J^T
  double residual = 0.0;  // C; of a bounded row its coordinate
  double impulse = 0.0;   // [N s] or [N m s]: of what holds or drives
  double stop = 0.0;      // of the limits: >= 0 of the lower one, <= 0 of the upper
  // Of what holds and of limits: the rate at which an error is taken out [1/s]; G as a share of
  // K_ii. One that is soft by the user's wish is not relaxed.
  double rate = 0.0, loss = 0.0;
  bool relaxes = true;
  bool bounded_hold = false;       // holds as held rows do, but within bounds
  double least = 0.0, most = 0.0;  // of what holds within bounds or drives [N s]
  // Of a drive: impulse = h (stiffness (position - q) + damping (speed - q')), within its bounds.
  double stiffness = 0.0, damping = 0.0, position = 0.0, speed = 0.0;
  double lower = -kNowhere, upper = kNowhere;  // of the coordinate
  std::uint8_t slot = 0;                       // which of the joint's coordinates it is of
};

struct JointBlock {
  std::uint32_t a = 0, b = 0;  // rows of the bodies
  int count = 0, held = 0;     // the first rows are held
  bool settled = false;        // the last round of pushing has hardly changed its impulses
  JointRow6 rows[kJointRows];
  double factor[kJointRows][kJointRows];  // below the diagonal L; on it 1 / D
};

// After the rows' Jacobians and residuals: answers, K and its factor.
void prepare(JointBlock& joint, const BodyRow* rows);
void warm_start(const JointBlock& joint, BodyRow* rows);
// A round of pushing. Those after the first of a sub-step may pass by what has settled.
void solve(JointBlock& joint, BodyRow* rows, double h);
// Takes from velocities what the push has added.
void relax(JointBlock& joint, BodyRow* rows, double h);

}  // namespace vp::solve
