// Joints between bodies: their part of the sub-steps of a step. Impulses go into lanes when these
// begin, and come back when they have ended.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "solve/body_row.h"
#include "solve/large_pages.h"
#include "world/body.h"
#include "world/joint.h"
#include "world/joint_runs.h"
#include "world/parallel.h"
#include "world/runs.h"

namespace vp {

struct JointContext {
  const Bodies& bodies;
  Joints& joints;
  std::span<solve::BodyRow> rows;
  std::span<const std::array<float, 6>> start_displacements;  // of each body
  const Workers& workers;
  double speed_unit;
};

// Kept for its capacity.
struct JointScratch {
  JointRuns runs;
  std::vector<std::uint32_t> active, joined_bodies;
  solve::LargeVector<solve::Gone> displacements;  // by row: of what is joined
};

// Of the sub-steps of a step; kept for its capacity.
struct SubStepScratch {
  BlockBits blocks;
  solve::LargeVector<solve::VelocityChange>
      velocity_changes;  // of each body, by the contacts of a sub-step
  std::vector<std::array<float, 6>>
      start_displacements;                       // of each body: its row's way when the step began
  std::vector<std::uint8_t> awake_body_changed;  // of each mover: it needs more than its own row
  JointScratch joints;
};

// Where a body's row has taken it since the step began.
BodyPose pose_within_step(const Body& body, const solve::BodyRow& row,
                          const std::array<float, 6>& start_displacement);

class JointSteps {
 public:
  JointSteps(const JointContext& context, JointScratch& scratch, double h);
  bool empty() const { return scratch_.active.empty(); }
  void prepare();
  void warm_start();
  void solve(int iteration);
  void relax();
  // Takes the impulses back. Returns whether one is far open.
  bool end(double dt);

 private:
  bool is_active(const BodyJoint& joint) const;
  BodyPose pose_within_step(std::uint32_t body) const;
  template <class F>
  void for_runs(const F& f);
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
