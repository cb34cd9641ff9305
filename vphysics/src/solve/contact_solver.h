// Contacts, friction and joint rows of one instant, by sequential impulses.
//
// Every body is given by the velocity (w, v) of one point of it. A free one answers by w a moment
// about that point, its centre of mass, with R I^-1 R^T, and by v a force through it with 1/m. A
// link does neither: it answers through its articulation's joints (link_side.h), so
// no joint can come apart, and its w and v stay those from before the solve.
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
  Sym3 angular;             // inverse inertia, world frame; zero for links and what nothing moves
  double inverse_mass;      // likewise
  Vec3 x;                   // the point, world frame
  Vec3 forced_w, forced_v;  // what this step's forces added to w and v
  int articulation, link;   // of a link; articulation is negative for all else
  bool in_blocks;           // others push it between rounds
};
static_assert(sizeof(SolverBody) == 30 * sizeof(double));

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
  double target;     // least normal speed after it
  double steady[3];  // speeds along the normal and the tangents, of steady contacts
  // Impulses; what they hold before the solve is the warm start.
  double normal_impulse;
  double tangent_impulse[2];
  double position_impulse;     // of the position correction
  double correction_fraction;  // prepared: of what others are corrected by
  // Of a step with sub-steps, over those: impulse, approach and whether it hit (note_sub_step).
  double step_impulse = 0.0, step_approach = 0.0;
  bool step_hits = false;
};

struct ContactConstraint {
  std::uint32_t a, b;  // bodies
  std::uint32_t collider_a, collider_b;
  Vec3 normal, tangent[2];
  double friction, restitution, rolling;
  double surface_speed[2];  // wanted relative velocity along the tangents [m/s]
  double rolling_mass;
  Vec3 rolling_impulse;
  int count;
  bool swept;  // belongs to a continuous body
  // By the solver: false where what it meets contradicts what others meet, as between two walls
  // that come together. Such impulses are no guess for the next step.
  bool consistent = true;
  // Prepared. An impulse moves the body itself; the body has no velocity, and gets none.
  bool moves_a, moves_b, stands_a, stands_b;
  bool is_steady() const { return !moves_a && !moves_b; }  // links alone answer
  ContactPoint points[collide::kMaxPoints];
  LinkSide side_a, side_b;  // prepared

  bool has_links() const { return side_a.depth + side_b.depth > 0; }
};

struct InstantScratch;  // instant_scratch.h

struct StepContext {
  std::span<SolverBody> bodies;
  std::span<ContactConstraint> contacts;
  // Those of trees, tree by tree; then, joint by joint, those between bodies, of which each has a
  // pair, in the same order.
  std::span<JointRow> joints;
  std::span<JointPair> pairs;
  std::span<SolverArticulation> articulations;
  std::vector<double>& rows;  // memory for those of links; keeps its capacity
  InstantScratch& scratch;    // and for the islands
  double duration;            // to the end of the step [s]
  double step;                // all of it [s]
  double slop;
  double restitution_threshold;
  int iterations;
  // Of a sub-step: share of a penetration that is pushed out, per time [1/s]; the fastest [m/s].
  double bias_rate = 0.0, max_bias_velocity = 0.0;
};

// Sets the unit normal and two tangents to it.
void set_normal(ContactConstraint& contact, const Vec3& normal);

// All of an instant.
void solve(const StepContext& context);

// The same in sub-steps, where others change the bodies' velocities between rounds, and where a
// penetration is pushed out by velocities that relax() takes back once they have moved everything:
// begin, solve as often as there are rounds, advance, relax, note_sub_step.
void begin_sub_step(const StepContext& context);
void solve_sub_step(const StepContext& context);
// The contacts after h at the velocities of now.
void advance_contacts(const StepContext& context, double h);
void relax_sub_step(const StepContext& context);
void note_sub_step(std::span<ContactConstraint> contacts);

}  // namespace vp::solve
