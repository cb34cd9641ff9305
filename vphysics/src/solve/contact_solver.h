// Solves the contacts, friction and joint rows of one instant by sequential impulses.
//
// Every body is represented by the velocity (w, v) of one point. For a free body this is the centre
// of mass: a moment about it changes w by R I^-1 R^T, a force through it changes v by 1/m. A link
// does neither: it responds through the joints of its articulation (link_side.h). So no joint can
// separate, and the link's w and v keep their values from before the solve.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "collide/manifold.h"
#include "solve/joint_row.h"
#include "solve/link_side.h"
#include "vphysics/lie.h"

namespace vp::solve {

struct SolverBody {
  Vec3 w, v;                // world frame; written by the solver
  Vec3 rotation, shift;     // position correction; written by the solver, applied by the world
  Sym3 angular;             // inverse inertia, world frame; zero for links and static bodies
  double inverse_mass;      // zero for links and static bodies
  Vec3 x;                   // the point, world frame
  Vec3 forced_w, forced_v;  // velocity changes from this step's forces, included in w and v
  int articulation, link;   // of a link; articulation is negative for any other body
  bool in_blocks;           // contact blocks change its velocity between iterations
};
static_assert(sizeof(SolverBody) == 30 * sizeof(double));

struct ContactPoint {
  // Input.
  Vec3 position;
  double separation;
  std::uint32_t feature;
  // Prepared.
  Vec3 arm_a, arm_b;  // from the bodies' points to the contact
  double normal_mass;
  double tangent_mass[3];  // inverse of the 2x2 tangent block: 11, 12, 22
  double slide_mass;       // inverse of the block's largest eigenvalue
  double approach;         // approach speed at the instant of contact, >= 0
  double early;  // part of the approach speed that the step's forces add only after the contact
  double fall;   // their increase of its square until the contact [m^2/s^2]
  bool hits;     // faster than the threshold; a resting contact does not hit
  bool bounces;
  double target;     // minimum normal speed after the solve
  double steady[3];  // speeds along the normal and the tangents, of steady contacts
  // Impulses. Their values before the solve are the warm start.
  double normal_impulse;
  double tangent_impulse[2];
  double position_impulse;     // impulse of the position correction
  double correction_fraction;  // prepared: the fraction of the correction of other contacts
  // In a step with sub-steps, accumulated over them: impulse, approach speed, whether it hit
  // (note_sub_step).
  double step_impulse = 0.0, step_approach = 0.0;
  bool step_hits = false;
};

struct ContactConstraint {
  std::uint32_t a, b;  // bodies
  std::uint32_t collider_a, collider_b;
  Vec3 normal, tangent[2];
  double friction, restitution, rolling;
  double surface_speed[2];  // target relative velocity along the tangents [m/s]
  double rolling_mass;
  Vec3 rolling_impulse;
  int count;
  bool swept;  // belongs to a continuous body
  // Set by the solver: false if this contact contradicts others, as between two walls that close on
  // a body. Such impulses are not used as a warm start.
  bool consistent = true;
  // Prepared. moves: an impulse moves the body itself. stands: the body's velocity is zero and
  // remains so.
  bool moves_a, moves_b, stands_a, stands_b;
  bool is_steady() const { return !moves_a && !moves_b; }  // only links can respond
  ContactPoint points[collide::kMaxPoints];
  LinkSide side_a, side_b;  // prepared

  bool has_links() const { return side_a.depth + side_b.depth > 0; }
};

struct InstantScratch;  // instant_scratch.h

struct StepContext {
  std::span<SolverBody> bodies;
  std::span<ContactConstraint> contacts;
  // Rows of articulations first, articulation by articulation; then those of joints between bodies,
  // joint by joint. Each of the latter has one pair, in the same order.
  std::span<JointRow> joints;
  std::span<JointPair> pairs;
  std::span<SolverArticulation> articulations;
  std::vector<double>& rows;  // memory for link rows; keeps its capacity
  InstantScratch& scratch;    // memory for islands
  double duration;            // from this instant to the end of the step [s]
  double step;                // the full step [s]
  double slop;
  double restitution_threshold;
  int iterations;
  // In a sub-step: the fraction of a penetration that the bias velocity removes, per time [1/s];
  // the maximum bias velocity [m/s].
  double bias_rate = 0.0, max_bias_velocity = 0.0;
};

// Sets the unit normal and two tangents to it.
void set_normal(ContactConstraint& contact, const Vec3& normal);

// Solves one instant.
void solve(const StepContext& context);

// The same in sub-steps. There, contact blocks change the bodies' velocities between iterations.
// Bias velocities remove penetration; relax_sub_step() removes the bias velocities after everything
// has moved. Call begin_sub_step, solve_sub_step once per iteration, advance_contacts,
// relax_sub_step, note_sub_step.
void begin_sub_step(const StepContext& context);
void solve_sub_step(const StepContext& context);
// Advances the contact points and separations by h at the current velocities.
void advance_contacts(const StepContext& context, double h);
void relax_sub_step(const StepContext& context);
void note_sub_step(std::span<ContactConstraint> contacts);

}  // namespace vp::solve
