// What a solver's stage may be asked to do, whatever the width of the machine's registers.
//
// passes.cpp and joint_passes.cpp are compiled once for each instruction set, with `vp` defined as
// another name, so that no function of one set can be taken for another's. All that the sets share
// has addresses and layouts in a namespace that keeps its name.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "solve/body_row.h"
#include "solve/contact_block.h"
#include "solve/joint_block.h"
#include "solve/speculative_list.h"

namespace vphysics_solver {

// How a contact answers penetration s < 0 in a sub-step h: as a spring and a damper of frequency f
// and damping ratio z, integrated implicitly, that is by
//   p' = p - share m (u + max(rate s, -max_bias_velocity)) - (1 - share) p
// What a deeper one lacks of  -rate s  moves the two bodies apart without a velocity, in all by no
// more than fastest_shift. Both limits are shared where a body has many contacts; that of the push
// is beyond what the loss of a load takes from it.
struct Soft {
  float rate;                  // [1/s]
  float fraction;              // of the effective mass, and what stays of the accumulated impulse
  float max_bias_velocity;     // [m/s]
  float inverse_h;             // [1/s]
  float keeps_load;            // 0 in the first sub-step of a step, else 1: of ContactBlock::given
  float fastest_shift = 0.0f;  // [m/s]
  float h = 0.0f;              // [s]
  // A contact without a load is left alone if no impact slower than this closes its gap [m/s].
  float idle_speed = 1.0f;
  bool last = false;  // the last sub-step of a step: relax tells what is too deep
};

// The passes over the blocks of one colour, of which `lanes` are used. One block a lane: of the
// last colour, whose contacts are solved one after the other; `stride` is then 1, else kLanes.
template <int P>
struct ContactPasses {
  using Blocks = ContactBlock<P>*;
  struct Run {
    Blocks blocks;
    std::uint32_t lanes, stride;
    BodyRow* rows;
  };
  // Before the sub-steps of a step.
  void (*load_inertias)(const Run& run);
  bool (*apply_restitution)(const Run& run, float h, float threshold);  // true: something bounced
  void (*warm_start)(const Run& run);
  // Rounds of pushing: the first of a sub-step, and those after it.
  void (*solve_first)(const Run& run, const Soft& soft);
  void (*solve_again)(const Run& run, const Soft& soft);
  bool (*relax)(const Run& run, const Soft& soft);  // true: one is too deep (kTooDeep)
  // Of all that find: a bit for each lane, a word for each block.
  void (*find_moved)(const Run& run, float dt, float rotation, std::uint32_t* bits);
  // Those of which there is something to tell: that they begin or end to touch, or a hit; in the
  // upper half of the word those that push. Marks the rows that something carries.
  void (*find_changes)(const Run& run, std::uint32_t* bits);
};

// What contacts have given a body's velocity in a sub-step, as it lies in its row; while that goes
// on, the velocity before them.
struct alignas(32) VelocityChange {
  float velocity[8];
};

struct Passes {
  // Of bodies, whose rows are one behind their numbers.
  void (*accelerate)(BodyRow* rows, const std::uint32_t* bodies, std::size_t count, float h);
  // keep: before the contacts of a sub-step, keeps the velocities. find_velocity_changes: after
  // them, leaves what they have given. repeat: before those of the next, keeps the velocities and
  // gives it once more. This is what warm_start does, as long as Jacobians stay and contacts alone
  // have acted.
  void (*keep)(BodyRow* rows, VelocityChange* velocity_changes, const std::uint32_t* bodies,
               std::size_t count);
  void (*find_velocity_changes)(BodyRow* rows, VelocityChange* velocity_changes,
                                const std::uint32_t* bodies, std::size_t count);
  void (*repeat)(BodyRow* rows, VelocityChange* velocity_changes, const std::uint32_t* bodies,
                 std::size_t count);
  void (*move)(BodyRow* rows, const std::uint32_t* bodies, std::size_t count, float h);
  // Bits of the near pairs that may go farther than they may by the end of a step dt.
  void (*find_closer)(SpeculativeBlock* blocks, std::size_t count, BodyRow* rows, float dt,
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
    BodyRow* rows;
    const Gone* gone;                // by row
    float max_bias_velocity = 3.0f;  // at which errors of hard rows are taken out [m/s]
    bool some_far = true;  // false: prepare has found none too large to be taken out at once
  };
  void (*load_inertias)(const Run& run);  // before the sub-steps of a step
  bool (*prepare)(const Run& run);        // true: an error is too large to be taken out at once
  void (*warm_start)(const Run& run);
  // Rounds of pushing: the first of a sub-step h, and those after it.
  void (*solve_first)(const Run& run, float h);
  void (*solve_again)(const Run& run, float h);
  void (*relax)(const Run& run, float h);
};
struct AllJointPasses {
  // Of bodies: how they have gone since their rows' ways were start.
  void (*find_gone)(const BodyRow* rows, const std::array<float, 6>* start,
                    const std::uint32_t* bodies, std::size_t count, Gone* gone);
  JointPasses<BallBlock> ball;
  JointPasses<AxesBlock> axes;
  JointPasses<FrameBlock> frames;
  JointPasses<RowsBlock> rows;
};

extern const Passes kBaseline;
extern const AllJointPasses kBaselineJoints;
// Only in libraries built with VP_INSTRUCTION_SETS.
extern const Passes kAvx2, kAvx512;
extern const AllJointPasses kAvx2Joints, kAvx512Joints;

}  // namespace vphysics_solver

namespace vp::solve {
using namespace vphysics_solver;  // NOLINT(google-build-using-namespace): see passes.h

// Those for this machine. All give the same bits.
const Passes& passes();
const AllJointPasses& joint_passes();

}  // namespace vp::solve
