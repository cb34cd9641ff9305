// Joints between bodies: their part of the sub-steps of a step.
#pragma once

#include <atomic>
#include <cstdint>
#include <span>
#include <vector>

#include "parallel.h"
#include "solve/body_state.h"
#include "solve/large_pages.h"
#include "world/body.h"
#include "world/fast_rotation.h"
#include "world/joint.h"
#include "world/joint_runs.h"
#include "world/precession.h"
#include "world/restarts.h"
#include "world/runs.h"

namespace vp {

struct JointContext {
  const Bodies& bodies;
  Joints& joints;
  std::size_t regions;  // with kSharedRegion
  std::span<solve::BodyState> states;
  std::span<const solve::StartDisplacement> start_displacements;  // of each body
  const Workers& workers;
  const Precession& precession;
  double speed_unit;
};

// Keeps its capacity between steps.
struct JointScratch {
  JointRuns runs;
  solve::LargeVector<solve::StepMotion> motions;  // by index of the state, for bodies with joints
  std::vector<std::uint8_t> some_far;             // of each region: JointPasses::Run::some_far
};

// Data of the sub-steps of a step. Keeps its capacity between steps.
struct SubStepScratch {
  BlockBits blocks;
  solve::LargeVector<solve::VelocityChange>
      velocity_changes;                           // of each body, by the contacts of a sub-step
  bool some_bounce = false;                       // a collider has or had restitution
  std::vector<solve::BounceShift> bounce_shifts;  // of each state; empty if none bounces
  std::vector<solve::StartDisplacement>
      start_displacements;  // of each body: displacement of its state at the start of the step
  solve::LargeVector<solve::SearchedMotion> searched;  // of each body
  FastRotationScratch fast_rotation;
  Precession precession;
  Restarts restarts;
  // Of each awake body; 1: its state alone does not advance it.
  std::vector<std::uint8_t> awake_body_changed;
  std::vector<std::uint32_t> accelerating;  // kinematic bodies whose velocity changes evenly
  JointScratch joints;
};

// The body's pose, advanced by its state's displacement since the start of the step.
BodyPose pose_within_step(const Body& body, const solve::BodyState& state,
                          const solve::StartDisplacement& start_displacement);

// An operation on a region writes the joints and bodies of that region alone, so regions other than
// kSharedRegion may run in parallel. begin() and prepare_and_relax() of all of them come before
// that of kSharedRegion, whose joints read how the bodies of others have moved.
class JointSteps {
 public:
  // h: the length of a sub-step.
  JointSteps(const JointContext& context, JointScratch& scratch, double h);
  bool empty() const { return is_empty_; }
  bool connect_regions() const { return !is_empty_ && scratch_.runs.connect_regions(); }
  // Copies the joints into blocks and prepares them.
  void begin(std::size_t region);
  void warm_start(std::size_t region);
  void solve(std::size_t region, int iteration);
  // After the bodies have moved.
  void prepare_and_relax(std::size_t region);
  // Copies the impulses back to the joints.
  void end(std::size_t region, double dt);
  // After end(): whether any joint is far open.
  bool some_are_far_open() const { return some_are_far_open_; }

 private:
  bool is_active(const BodyJoint& joint) const;
  void request(std::span<const JointLane> lanes, std::size_t i) const;
  BodyPose pose_within_step(std::uint32_t body) const;
  template <class F>
  void for_parts_of(std::size_t region, const F& f);
  template <class F>
  void prepare(std::size_t region, const F& f);
  template <class BLOCK>
  void fill(BLOCK& block, const JointRun<BLOCK>& run, std::size_t index);
  template <class BLOCK>
  void fill_lane(BLOCK& block, int lane, const JointLane& from);
  template <class Part>
  void evaluate_rows(const Part& part);
  void evaluate_block(solve::RowsBlock& block);
  template <class BLOCK>
  void take(const BLOCK& block, int lane, double dt, bool some_far);
  template <class BLOCK>
  bool is_far_open(const BodyJoint& joint, const BLOCK& block, int lane) const;

  const JointContext context_;
  JointScratch& scratch_;
  const double h_;
  bool is_empty_ = true;
  std::atomic<bool> some_are_far_open_ = false;
};

}  // namespace vp
