// Data of the solver in double precision (solve/contact_solver.h), of one instant of the impact
// stage or of one sub-step of articulations: rows of joints, and the bodies that these and contacts
// act on.
//
//   add_rows               motors, springs and stops of articulations; joints in rows
//   load_body              each body of a contact or a pair
//   load_articulation
//   context                for the solver
//   note_link_impulses, take_back_joints
//
// Reads articulations, joints and bodies. Writes the impulses of joints and the external impulses
// of articulations.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "solve/contact_solver.h"
#include "solve/instant_scratch.h"
#include "world/row_joints.h"
#include "world/step_context.h"

namespace vp {

class RowSolve {
 public:
  explicit RowSolve(const StepContext& context) : s_(context) {}

  // Reserves memory for the rows of all joints. Call it after bodies, joints or articulations were
  // added.
  void reserve();
  void begin_step(std::size_t contacts);
  // Instead of begin_step(): no joint in rows takes part in this step.
  void forget_joints() { joints_.clear(); }

  // Joints in rows that are alive (row_joints.h), and whether one is solved in the sub-steps.
  std::span<const std::uint32_t> joints() const { return joints_; }
  bool is_in_sub_steps(const BodyJoint& joint) const;

  void add_rows(const RowJointStep& step);
  std::span<const solve::JointRow> rows() const { return rows_; }
  std::span<const solve::JointPair> pairs() const { return pairs_; }
  bool empty() const { return rows_.empty(); }

  // The body's data for the solver, with its reference point at `at`. forced: its velocity change
  // from the forces.
  solve::SolverBody& load_body(std::uint32_t body, const Vec3& at, const Velocity& forced);
  solve::SolverBody& body(std::uint32_t body) { return bodies_[body]; }
  void load_articulation(std::uint32_t articulation, bool whole_step) {
    articulations_[articulation] = s_.articulations[articulation].begin_solve(whole_step);
  }
  solve::StepContext context(std::span<solve::ContactConstraint> contacts, double duration,
                             double step);

  // Records the impulses of solved contacts on links, at the contact points of the solver.
  void note_link_impulses(std::span<const solve::ContactConstraint> solved);
  void take_back_joints(const RowJointStep& step);
  // Checks the joints in rows at the end of a step.
  void note_open_joints();

 private:
  void list_joints();
  void add_rows_of_articulations(const RowJointStep& step);
  void find_next_poses(double h);
  RowEnd row_end(std::uint32_t body, const RowJointStep& step) const;
  void add_rows_of_joints(const RowJointStep& step);

  const StepContext s_;
  std::vector<std::uint32_t> joints_;
  std::size_t most_dofs_ = 0;    // of an articulation
  std::vector<SE3> next_poses_;  // of each body: next pose, of links in these joints

  // --- of the solve
  std::vector<solve::JointRow> rows_;
  std::vector<solve::JointPair> pairs_;
  std::vector<solve::SolverBody> bodies_;                 // of each body
  std::vector<solve::SolverArticulation> articulations_;  // of each articulation
  std::vector<double> link_rows_;
  solve::InstantScratch instant_;
};

}  // namespace vp
