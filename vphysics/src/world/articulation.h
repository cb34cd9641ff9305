// An articulation of a world: its model, its state, and its step.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "collide/bounds.h"
#include "solve/link_side.h"
#include "vphysics/multibody/dynamics.h"
#include "vphysics/world.h"
#include "world/floating_tree.h"
#include "world/implicit_forces.h"
#include "world/joint_dof.h"
#include "world/joint_reactions.h"

namespace vp {

class Articulation {
 public:
  Articulation(const Model& model, const Vec3& gravity);

  // --- state; call refresh() after changing q or v
  std::vector<double> q, v;
  std::vector<JointDof> dofs;         // one per velocity
  std::vector<std::uint32_t> bodies;  // the body of each link
  bool alive = true;
  std::uint32_t generation = 1;  // of its index

  const Model& model() const { return model_; }
  std::uint32_t body_of(int link) const { return bodies[static_cast<std::size_t>(link)]; }
  // The index of a joint's degree of freedom among the velocities, or -1.
  int dof_index(int link, int dof) const {
    if (link < 0 || link >= static_cast<int>(bodies.size()) || dof < 0) return -1;
    const std::size_t l = static_cast<std::size_t>(link);
    const int i = first_dof_[l] + dof;
    return i < first_dof_[l + 1] ? i : -1;
  }
  std::size_t deepest() const { return factor_.deepest(); }
  bool is_fixed(int link) const { return factor_.depth(link) == 0; }
  // Whether every joint moves inertia in the initial configuration.
  bool is_regular() const { return regular_; }

  // Updates poses and velocities of the links from q and v: a link's pose, its angular velocity and
  // the velocity of one of its points, in the world frame.
  void refresh();
  SE3 T_world_link(int link) const;
  // Unit vector, in the world frame, of the line through the link's origin along which it slides
  // and about which it rotates, if that is all its motion. Otherwise zero.
  Vec3 line_of(int link) const;
  // Whether advance() leaves the links' velocities unchanged: all move along such lines.
  bool keeps_twists() const { return keeps_twists_; }
  se3 link_velocity(int link, const Vec3& point) const {
    return twists_ ? factor_.twist_at(link, point) : twist_in_data(link, point);
  }

  // Integrates the forces over dt into v: gravity, velocity-dependent forces, the user's forces and
  // viscous joint damping, the last implicitly. False if a joint moves no inertia. changed: whether
  // v has changed.
  // Also motors and springs that are in the factor (implicit_forces.h).
  bool integrate_forces(double dt, bool& changed);
  const ImplicitForces& implicit() const { return implicit_; }
  // After the solver's iterations (solved), or without them: motors in the factor that exceed their
  // limit. They become rows, or all_become_rows if there are any, which bounds the number of
  // solves; true if there are any. restart_forces() then returns to the velocities at the start of
  // the step.
  bool find_saturated_motors(bool solved, bool all_become_rows);
  void restart_forces();
  // Stores the impulses of the forces in the factor, at the velocities after the solve.
  void store_implicit_impulses();
  // Advances q by h [s] at the velocities v.
  void advance(double h);
  // Calls f(link, T_world_link) for all links at the poses after h at the velocities v.
  template <class F>
  void for_poses_after(double h, const F& f) {
    predict_poses(h);
    for (int link = 0; link < static_cast<int>(bodies.size()); ++link) f(link, T_world_link(link));
    restore_poses();
  }
  // Centre of mass in the link frame; the link's origin if it has no mass.
  Vec3 centre_of(int link) const {
    const Inertia& inertia = model_.link(link).inertia;
    return inertia.mass() > 0.0 ? inertia.centre_of_mass() : Vec3{};
  }

  // Replaces the solver at the first instant of a step for an articulation that nothing touches and
  // whose joints are not coupled: computes its motors' impulses over h directly. False, with no
  // change, if it needs the solver.
  bool solve_decoupled(double h);
  bool is_decoupled() const { return !responses_.empty(); }
  // Call after a change of any dof's drive.
  void drives_changed() { drives_are_compared_ = false; }
  // Prepares the solver: the response in the current configuration, with zero impulses. end_solve()
  // applies the solver's velocity changes, and its coordinate corrections clamped to the limits.
  // whole_step: the impulses act during the whole step, so the joints' damping resists them.
  solve::SolverArticulation begin_solve(bool whole_step);
  enum class Change { none, of_velocities, of_coordinates_too };
  Change end_solve();
  // World frame. False, with no change, if a velocity would leave the range.
  bool apply_impulse(int link, const Vec3& impulse, const Vec3& point);

  // --- the user's forces for the next step (forces.cpp)
  // On a link: about its origin, world axes.
  // On a link: about its origin, world axes.
  dse3 load(int link) const { return loads_[static_cast<std::size_t>(link)]; }
  void set_load(int link, const dse3& load) {
    loads_[static_cast<std::size_t>(link)] = load;
    loaded_ = true;
  }
  // Of a degree of freedom, by velocity index.
  double joint_load(std::size_t dof) const { return joint_loads_[dof]; }
  void set_joint_load(std::size_t dof, double force) {
    joint_loads_[dof] = force;
    loaded_ = true;
  }
  bool is_loaded() const { return loaded_; }
  void clear_loads();
  // Marks it as destroyed; its index can be reused.
  void destroy() {
    clear_loads();
    alive = can_be_remote = remote = sub_stepped = touched = false;
  }

  // --- in sub-steps, while sub-stepped bodies are on its links (link_contacts.cpp)
  bool sub_stepped = false;  // in this step
  // Whether velocity-dependent forces will change its velocities far in a step dt.
  bool turns_far(double dt);
  bool touched = false;          // by a contact of the current instant, in the impact stage
  bool needs_next_pose = false;  // scratch of find_next_poses (row_solve.cpp)
  // Stores the velocities at which advance_sub_step() moves: v with the solver's changes so far.
  // end_solve() may still change v.
  void store_sub_step_velocity();
  void advance_sub_step(double h);
  // Returns to the pose at the start of the step; advance() then moves to the end pose again, and v
  // is that of the end. Until refresh(), drift_of() returns the mean velocity of a link over the
  // step less its velocity at the end.
  void end_sub_steps(double dt);
  se3 drift_of(int link, const Vec3& point) const { return factor_.twist_at(link, point); }

  // --- remote: nothing can collide with it (remote.cpp). q and v advance; all derived data wait
  // for refresh()
  bool can_be_remote = false, remote = false;
  collide::Bounds remote_box;  // of all its links, enlarged by how far they may slide
  void set_remote(const collide::Bounds& box);
  // Upper bound of how far a link has slid since set_remote(), plus its slide in h [m].
  double slides_since_remote(double h) const;

  bool in_range() const;
  // Removes a fraction of the velocity changes from the step's forces, only where they increased
  // the speed and never past zero.
  void take_back_forces(double fraction);

  // Stores the coordinates at the start of the step, to which return_to_start() returns at rest.
  void mark_start() {
    start_q_ = q;
    start_v_ = v;
    reactions_.begin_step(v);
    std::fill(forced_.begin(), forced_.end(), 0.0);
  }
  void return_to_start();

  // --- joint reactions of the last step (joint_reactions.h)
  // Records an impulse on a link in the current step, from outside its joints; world frame, moment
  // about the world's origin. Everything that acts on links must be recorded here.
  void add_external_impulse(int link, const Vec3& impulse, const Vec3& moment) {
    reactions_.add_impulse(link, impulse, moment);
  }
  // Along a degree of freedom, except the impulses of its rows for the whole step.
  void add_effort(std::uint32_t dof, double impulse) { reactions_.add_effort(dof, impulse); }
  void end_step(double dt) {
    if (loaded_) reactions_.note_loads(loads_, joint_loads_);
    reactions_.end_step(dt);
  }
  // Call before q or v are set.
  void keep_end_of_step() { reactions_.keep_end(q, v); }
  void forget_step() { reactions_.forget(); }
  // Null: no step is known.
  const JointReactions* reactions();

 private:
  void predict_poses(double h);
  void restore_poses();
  void update_factor();
  void update_twists();
  void find_lines();
  void find_responses();
  void compare_drives();
  bool stops_are_inactive(double h) const;
  void update_line_poses();
  se3 twist_in_data(int link, const Vec3& point) const;
  void find_change(double dt, std::span<const double> at);
  void find_change_at_middle(double dt);
  void find_midpoint_change(double dt);
  void find_force_response();
  void add_loads_of_trees(double dt);
  void add_impulse(int link, double dt);
  void add_joint_impulse(std::uint32_t dof, double dt);
  bool add_forces(double dt, bool& changed);
  bool factor_for_step(double dt);
  void add_damping_efforts(std::span<const double> gained);
  bool add_constant_forces(double dt);
  void advance_floating(double h);

  Model model_;
  Vec3 gravity_;
  Data data_;
  detail::ImpulseFactor factor_;
  std::vector<FloatingTree> floating_;
  std::vector<int> first_dof_;        // of each link, and the end of the last
  std::vector<std::size_t> stopped_;  // degrees of freedom with hard stops
  std::vector<double> damping_;       // of each degree of freedom
  bool damped_ = false;
  bool has_user_joints_ = false;  // only the model's own passes evaluate them
  // All joints of a tree slide along or rotate about one line on which all masses are balanced, and
  // none is damped, as with the rods of a table. The mass matrix and the gravity forces are then
  // constant, and there are no velocity-dependent forces. One factor serves for all steps. data_ is
  // not used: with so few joints its passes' SIMD lanes would be almost empty.
  bool constant_ = false;
  // If constant_: the coordinates along which links slide, and the slide per unit of coordinate.
  struct Slider {
    std::size_t q, v;
    double slides;
  };
  std::vector<Slider> sliders_;
  // If constant_: how far each node has slid along its line and rotated about it.
  struct OnLine {
    double slides, turns;  // per unit of its own coordinate
    double slide, rotation;
    double sine, cosine;  // of the rotation
  };
  std::vector<OnLine> on_line_;         // of each node
  std::vector<SE3> T_world_line_;       // of each link: frame of its line,
  std::vector<SE3> T_line_link_;        // and its pose in that frame at zero coordinates
  std::vector<std::uint8_t> is_axial_;  // this pose only shifts along the line
  bool keeps_twists_ = false;           // all links are plain
  // Velocity change of each coordinate per unit impulse of its own motor. Empty: joints are
  // coupled, or have more than motors and stops.
  std::vector<double> responses_;
  // Of each velocity: drive and response equal those of the previous one.
  std::vector<std::uint8_t> same_drive_as_previous_;
  bool drives_are_compared_ = false;
  enum class Factored : std::uint8_t { no, without_damping, for_the_step };
  Factored factored_ = Factored::no;  // of the current configuration
  double factored_time_ = 0.0;        // step length of Factored::for_the_step
  ImplicitForces implicit_;           // of the current step
  bool implicit_is_chosen_ = false;   // the forces of this step are integrated again
  bool changes_are_found_ = false;    // velocity_: velocity changes instead of z
  bool inertias_ = false;             // the factor has the inertias of the current configuration
  bool twists_ = false;  // the factor has the links' velocities, otherwise data_ has them
  bool regular_ = false;
  bool loaded_ = false;
  std::vector<dse3> loads_;          // of each link
  std::vector<double> joint_loads_;  // of each degree of freedom
  std::vector<int> floating_of_;     // of each link: index of its floating tree, or -1
  JointReactions reactions_;

  // Scratch.
  std::vector<double> sub_step_velocity_,
      drift_;                   // sub-steps: v while moving; mean velocity less v
  std::vector<double> forced_;  // velocity changes from the forces of this step
  std::vector<double> start_q_, start_v_, moved_q_, rate_, change_, last_change_, force_, zero_,
      applied_forces_, velocity_, shift_;
  std::vector<double> remote_q_;
  std::vector<CompositeBody> composites_;
  std::vector<double> gravity_acceleration_;  // acceleration from gravity if constant_
};

}  // namespace vp
