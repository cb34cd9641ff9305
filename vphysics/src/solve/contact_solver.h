// Contacts, friction and joint rows of one instant, by sequential impulses.
//
// Every body, free or link, is given by the velocity (w, v) of one point of it and by two symmetric
// blocks: how w answers a moment about that point, and v a force through it. For a free body the
// point is the centre of mass and the blocks are R I^-1 R^T and 1/m. For a link with its joint on
// the world the point lies on the axis a, and the reduced inertia leaves a a^T / M_angle and a a^T
// / M_slide: an impulse changes the joint's rates and nothing else, so a joint cannot come apart.
#pragma once

#include <cstdint>
#include <span>

#include "collide/manifold.h"
#include "vphysics/lie.h"

namespace vp::solve {

struct SolverBody {
  Vec3 w, v;                // world frame; written by the solver
  Vec3 turn, shift;         // position correction; written by the solver, applied by the world
  Sym3 angular, linear;     // inverse inertia, world frame; zero for what nothing moves
  Vec3 x;                   // the point, world frame
  Vec3 forced_w, forced_v;  // what this step's forces added to w and v
};
static_assert(sizeof(SolverBody) == 33 * sizeof(double));

struct ContactPoint {
  // Given.
  Vec3 position;
  double separation;
  std::uint32_t feature;
  // Prepared.
  Vec3 arm_a, arm_b;  // from the bodies' points to the contact
  double normal_mass;
  double tangent_mass[3];  // inverse of the 2x2 tangent block: 11, 12, 22
  double slide_mass;       // inverse of the block's largest eigenvalue
  double approach;         // speed of approach at the instant of contact, >= 0
  double early;            // part of the approach that the step's forces add only after it
  double fall;             // what they add to its square while the gap closes [m^2/s^2]
  bool hits;               // faster than the threshold; what rests does not hit
  bool bounces;
  double target;  // least normal speed after it
  // Impulses; what they hold before the solve is the warm start.
  double normal_impulse;
  double tangent_impulse[2];
  double push;  // of the position correction
};

struct ContactConstraint {
  std::uint32_t a, b;  // bodies
  std::uint32_t collider_a, collider_b;
  Vec3 normal, tangent[2];
  double friction, restitution, rolling;
  double rolling_mass;
  Vec3 rolling_impulse;
  int count;
  bool swept;  // belongs to a continuous body
  ContactPoint points[collide::kMaxPoints];
};

// One joint coordinate: impulse in [lower, upper] so that rate + softness * impulse = target.
struct JointRow {
  std::uint32_t body;
  Vec3 axis;
  bool angular;
  double inverse_mass;
  double target;
  double softness;  // 0: hard
  double lower, upper;
  double impulse;    // before the solve: the warm start
  double* remember;  // where the world keeps the impulse for the next step; may be null
};

struct StepContext {
  std::span<SolverBody> bodies;
  std::span<ContactConstraint> contacts;
  std::span<JointRow> joints;
  double duration;  // to the end of the step [s]
  double step;      // all of it [s]
  double slop;
  double restitution_threshold;
  int iterations;
};

// Sets the unit normal and two tangents to it.
void set_normal(ContactConstraint& contact, const Vec3& normal);

void solve(const StepContext& context);

}  // namespace vp::solve
