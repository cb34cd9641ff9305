// The interface of the solver's passes, independent of the SIMD width.
//
// passes.cpp and joint_passes.cpp are compiled once for each instruction set. For each, `vp` is
// defined as a different name, so that the linker cannot merge functions of two sets. Everything
// that the sets share has its addresses and layouts in a namespace that keeps its name.
#pragma once

#include <cstddef>
#include <cstdint>

#include "solve/body_state.h"
#include "solve/contact_block.h"
#include "solve/joint_block.h"
#include "solve/new_contacts.h"
#include "solve/speculative_list.h"

namespace vphysics_solver {

// A soft contact's response to penetration s < 0 in a sub-step h: an implicitly integrated spring
// and damper of frequency f and damping ratio z,
//   p' = p - fraction m (u + max(rate s, -max_bias_velocity)) - (1 - fraction) p
// For deeper penetration, a position correction moves the two bodies apart at the remaining speed,
// -rate s - max_bias_velocity, at most at fastest_shift in total. If a body has many contacts, each
// gets only a fraction of both limits. The maximum bias velocity does not include the speed that
// softness takes from a load.
struct Soft {
  float rate;               // [1/s]
  float fraction;           // of the effective mass, and what remains of the accumulated impulse
  float max_bias_velocity;  // [m/s]
  float inverse_h;          // [1/s]
  float keeps_load;  // factor on ContactBlock::given: 0 in the first sub-step of a step, else 1
  float fastest_shift = 0.0f;  // [m/s]
  float h = 0.0f;              // [s]
  // A contact without a load is skipped if an additional approach speed of this [m/s] would not
  // close its separation within the sub-step.
  float idle_speed = 1.0f;
  bool last = false;  // the last sub-step of a step: relax reports contacts that are too deep
};

// The passes over the blocks of one colour, in which `slots` slots are in use. `stride` is kLanes.
// In the last colour it is 1, one slot per block, since its contacts are solved one after another.
template <int P>
struct ContactPasses {
  using Blocks = ContactBlock<P>*;
  struct Run {
    Blocks blocks;
    std::uint32_t slots, stride;
    BodyState* states;
  };
  // Writes new contacts into the slots of a block.
  void (*renew)(ContactBlock<P>& block, const NewContacts& contacts);
  // Before the sub-steps of a step.
  void (*load_inertias)(const Run& run);
  // Returns true if something bounced. Adds to the shifts, which are by index of the state.
  bool (*apply_restitution)(const Run& run, float h, float threshold, BounceShift* shifts);
  void (*warm_start)(const Run& run);
  // Iterations with bias velocities: the first of a sub-step, and later ones.
  void (*solve_first)(const Run& run, const Soft& soft);
  void (*solve_again)(const Run& run, const Soft& soft);
  bool (*relax)(const Run& run, const Soft& soft);  // true: a contact is too deep (kTooDeep)
  // All find functions: a bit per slot, a word per block.
  void (*find_moved)(const Run& run, float dt, float rotation, std::uint32_t* bits);
  // Slots with something to report: a contact that begins or ends, or a hit. The upper half of the
  // word has the slots that touch: with a load in this sub-step or, with keeps_load 1, in an
  // earlier one of the step. Marks the bodies that are supported.
  void (*find_changes)(const Run& run, float keeps_load, std::uint32_t* bits);
};

// The change of a body's velocity by the contacts of a sub-step, in the layout of its state. During
// the sub-step it stores the velocity before the contacts.
struct alignas(32) VelocityChange {
  float velocity[8];
};

// The velocity by which the last search for contacts extrapolated a body's motion, in the layout of
// its state, and how far the body may deviate from that motion before the search is repeated: the
// distance [m] for each component of v, the angle [rad] for each of w.
struct alignas(32) SearchedMotion {
  float velocity[6];
  float distance, angle;
};

struct Passes {
  // Over bodies. The state of body i is i + 1.
  void (*accelerate)(BodyState* states, const std::uint32_t* bodies, std::size_t count, float h);
  // keep: stores the velocities, before the contacts of a sub-step. find_velocity_changes: stores
  // the velocity changes, after them. repeat: before the contacts of the next sub-step, stores the
  // velocities and applies the changes once more. This equals warm_start as long as the Jacobians
  // are unchanged and only contacts have acted.
  void (*keep)(BodyState* states, VelocityChange* velocity_changes, const std::uint32_t* bodies,
               std::size_t count);
  void (*find_velocity_changes)(BodyState* states, VelocityChange* velocity_changes,
                                const std::uint32_t* bodies, std::size_t count);
  void (*repeat)(BodyState* states, VelocityChange* velocity_changes, const std::uint32_t* bodies,
                 std::size_t count);
  void (*move)(BodyState* states, const std::uint32_t* bodies, std::size_t count, float h);
  // Sets the flag of each body that deviates by more than its limit, over the time `left`, from the
  // motion of the last search; clears those of the others. Returns whether it has set any.
  bool (*find_deviating)(const BodyState* states, const SearchedMotion* searched,
                         const std::uint32_t* bodies, std::size_t count, float left,
                         std::uint8_t* flags);
  // A bit for each speculative pair that may use up its clearance by the end of a step dt.
  void (*find_closer)(SpeculativeBlock* blocks, std::size_t count, BodyState* states, float dt,
                      std::uint32_t* bits);
  ContactPasses<1> one;
  ContactPasses<4> four;
};

// The passes over the blocks of one form and colour.
template <class BLOCK>
struct JointPasses {
  struct Run {
    BLOCK* blocks;
    std::size_t count;  // of blocks
    const JointForm* form;
    BodyState* states;
    const StepMotion* motions;       // by index of the state
    float max_bias_velocity = 3.0f;  // for errors of hard rows [m/s]
    bool some_far = true;            // false: prepare has returned false for all
  };
  void (*load_masses)(const Run& run);    // before the sub-steps of a step
  void (*load_inertias)(const Run& run);  // after its bodies have precessed
  // Returns true if an error is too large to be corrected at its full rate.
  bool (*prepare)(const Run& run);
  void (*warm_start)(const Run& run);
  // Iterations with bias velocities: the first of a sub-step h, and later ones.
  void (*solve_first)(const Run& run, float h);
  void (*solve_again)(const Run& run, float h);
  void (*relax)(const Run& run, float h);
};
struct AllJointPasses {
  // Over bodies: their motion since the states' displacements were `start`.
  void (*find_step_motions)(const BodyState* states, const StartDisplacement* start,
                            const std::uint32_t* bodies, std::size_t count, StepMotion* motions);
  // Over bodies that have moved by a sub-step h: their rotation in it becomes that of free bodies,
  // and their angular velocities and inverse inertias those at its end. inertias: of each of them.
  void (*precess)(BodyState* states, const StartDisplacement* start, const std::uint32_t* bodies,
                  std::size_t count, const BodyInertia* inertias, float h);
  JointPasses<BallBlock> ball;
  JointPasses<AxesBlock> axes;
  JointPasses<FrameBlock> frames;
  JointPasses<RowsBlock> rows;
};

extern const Passes kBaseline;
extern const AllJointPasses kBaselineJoints;
// Defined only in libraries built with VP_INSTRUCTION_SETS.
extern const Passes kAvx2, kAvx512;
extern const AllJointPasses kAvx2Joints, kAvx512Joints;

}  // namespace vphysics_solver

namespace vp::solve {
using namespace vphysics_solver;  // NOLINT(google-build-using-namespace): see passes.h

// The tables for this machine. All give the same bits.
const Passes& passes();
const AllJointPasses& joint_passes();

}  // namespace vp::solve
