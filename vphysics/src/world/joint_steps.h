// Joints between bodies: their part of the sub-steps of a step. The constructor copies impulses
// into the blocks; end() copies them back.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "solve/body_state.h"
#include "solve/large_pages.h"
#include "world/body.h"
#include "world/fast_rotation.h"
#include "world/joint.h"
#include "world/joint_runs.h"
#include "world/parallel.h"
#include "world/runs.h"

namespace vp {

struct JointContext {
  const Bodies& bodies;
  Joints& joints;
  std::span<solve::BodyState> states;
  std::span<const std::array<float, 6>> start_displacements;  // of each body
  const Workers& workers;
  double speed_unit;
};

// Keeps its capacity between steps.
struct JointScratch {
  JointRuns runs;
  std::vector<std::uint32_t> active, joined_bodies;
  solve::LargeVector<solve::StepMotion> motions;  // by index of the state, for bodies with joints
};

// Data of the sub-steps of a step. Keeps its capacity between steps.
struct SubStepScratch {
  BlockBits blocks;
  solve::LargeVector<solve::VelocityChange>
      velocity_changes;  // of each body, by the contacts of a sub-step
  std::vector<std::array<float, 6>>
      start_displacements;  // of each body: displacement of its state at the start of the step
  solve::LargeVector<solve::SearchedMotion> searched;  // of each body
  FastRotationScratch fast_rotation;
  // Of each awake body; 1: its state alone does not advance it.
  std::vector<std::uint8_t> awake_body_changed;
  JointScratch joints;
};

// The body's pose, advanced by its state's displacement since the start of the step.
BodyPose pose_within_step(const Body& body, const solve::BodyState& state,
                          const std::array<float, 6>& start_displacement);

class JointSteps {
 public:
  JointSteps(const JointContext& context, JointScratch& scratch, double h);
  bool empty() const { return scratch_.active.empty(); }
  void warm_start();
  void solve(int iteration);
  // After the bodies have moved.
  void prepare_and_relax();
  // Copies the impulses back. Returns whether any joint is far open.
  bool end(double dt);

 private:
  bool is_active(const BodyJoint& joint) const;
  BodyPose pose_within_step(std::uint32_t body) const;
  template <class F>
  void for_runs(const F& f);
  template <class Before, class After>
  void prepare(const Before& before, const After& after);
  void fill(std::uint32_t joint);
  void evaluate_rows(solve::RowsBlock& block);
  template <class BLOCK>
  bool is_far_open(const BodyJoint& joint, const BLOCK& block, int lane) const;

  const JointContext context_;
  JointScratch& scratch_;
  const double h_;
  bool some_are_far_ = false;  // JointPasses::Run::some_far
};

}  // namespace vp
