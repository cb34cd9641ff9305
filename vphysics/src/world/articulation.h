// An articulation of a world: a model, its state, and what a step does to it.
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
#include "world/joint_reactions.h"

namespace vp {

// The rows that a degree of freedom may have in the solver.
enum RowOfDof : std::uint8_t {
  kMotorRow,
  kFrictionRow,  // or the lock, where it is infinite
  kSpringRow,
  kLowerRow,  // limits: stops, or springs
  kUpperRow,
  kRowsOfDof
};

// One degree of freedom.
struct JointDof {
  int coordinate = -1;  // its place in q; -1: of a ball or a free joint, where there is none
  JointForces forces;
  double lower = -1e30, upper = 1e30;  // stops
  bool locked = false;                 // by infinite friction
  bool passive = false;                // has a spring, friction, or limits that give way
  JointDrive drive;
  // Of each of its rows in the last step, from which the next solve starts.
  std::array<double, kRowsOfDof> impulses{};
};

// A motor for h. With f = k (p - q - h v) + d (v_t - v) its impulse is push - gain v, v being the
// velocity after it, and at most `most`; without a motor both are 0.
struct Motor {
  double constant = 0.0, gain = 0.0, limit = 0.0;
};
inline Motor motor_of(const JointDof& dof, double h, double position) {
  const JointDrive& d = dof.drive;
  const double limit = h * std::min(d.max_force, dof.forces.motor_limit);
  const double gain = h * (h * d.stiffness + d.damping);
  if (!(gain > 0.0 && limit > 0.0)) return {};
  return {h * (d.stiffness * (d.position - position) + d.damping * d.velocity), gain, limit};
}

class Articulation {
 public:
  Articulation(const Model& model, const Vec3& gravity);

  // --- state; refresh() follows a change of q or v from outside
  std::vector<double> q, v;
  std::vector<JointDof> dofs;         // of each velocity
  std::vector<std::uint32_t> bodies;  // of each link
  bool alive = true;
  std::uint32_t generation = 1;  // of its slot

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
  // As it was made, every joint moves inertia.
  bool is_regular() const { return regular_; }

  // Poses and velocities of the links from q and v: a link's pose, its angular velocity and that of
  // a point of it, in the world frame.
  void refresh();
  SE3 T_world_link(int link) const;
  // The line along which the link slides and about which it turns, all of its motion: a unit vector
  // through its origin, in the world frame. Zero: it moves otherwise.
  Vec3 line_of(int link) const;
  // Moving on takes nothing from its links' velocities: they are on such lines.
  bool keeps_twists() const { return keeps_twists_; }
  se3 link_velocity(int link, const Vec3& point) const {
    return twists_ ? factor_.twist_at(link, point) : twist_in_data(link, point);
  }

  // v after the forces of dt: gravity, those of the velocities, the joints' viscous damping; the
  // last is integrated implicitly. False if a joint moves no inertia. changed: v is another.
  bool integrate_forces(double dt, bool& changed);
  // q after h seconds at the velocities v.
  void advance(double h);
  // f(link, T_world_link) of all links, as they would be after h at the velocities v.
  template <class F>
  void for_poses_after(double h, const F& f) {
    look_ahead(h);
    for (int link = 0; link < static_cast<int>(bodies.size()); ++link) f(link, T_world_link(link));
    look_back();
  }
  // The centre of mass, in the link's frame; its origin if it has no mass.
  Vec3 centre_of(int link) const {
    const Inertia& inertia = model_.link(link).inertia;
    return inertia.mass() > 0.0 ? inertia.centre_of_mass() : Vec3{};
  }

  // What the solver does for an articulation that nothing touches and of which no joint feels
  // another, at the first instant of a step: its motors, whose impulses for h are known at once.
  // False, and nothing done, where it needs the solver.
  bool integrate_alone(double h);
  bool settles_alone() const { return !responses_.empty(); }
  // After a change of any dof's drive.
  void drives_changed() { drives_are_compared_ = false; }
  // For the solver: the response of the present configuration, and nothing pushed yet. end_solve()
  // takes over what it did, corrections of the coordinates within the limits. whole_step: of
  // impulses that act all along the step, which the joints' damping resists meanwhile.
  solve::SolverArticulation begin_solve(bool whole_step);
  enum class Change { none, of_velocities, of_coordinates_too };
  Change end_solve();
  // World frame. False, and nothing changes, if a velocity would leave the range.
  bool apply_impulse(int link, const Vec3& impulse, const Vec3& point);

  // --- forces of the user for the next step (forces.cpp)
  // On a link: about its origin, world axes.
  dse3 load(int link) const { return loads_[static_cast<std::size_t>(link)]; }
  void set_load(int link, const dse3& load) {
    loads_[static_cast<std::size_t>(link)] = load;
    loaded_ = true;
  }
  // Of a velocity's degree of freedom.
  double joint_load(std::size_t dof) const { return joint_loads_[dof]; }
  void set_joint_load(std::size_t dof, double force) {
    joint_loads_[dof] = force;
    loaded_ = true;
  }
  bool is_loaded() const { return loaded_; }
  void clear_loads();
  // It is one no longer: its slot waits for another.
  void destroy() {
    clear_loads();
    alive = can_be_remote = remote = sub_stepped = touched = false;
  }

  // --- in sub-steps, when bodies that have them lie on its links (link_contacts.cpp)
  bool sub_stepped = false;  // in this step
  bool touched = false;      // by a contact of this instant, in the stage of impacts
  bool wants_next = false;   // scratch of find_next_poses (link_joints.cpp)
  // With what the solver has done so far it will move; end_solve() may change its velocities yet.
  void mark_moving();
  void advance_sub_step(double h);
  // Back to where the step began; advance() will take it where it was, v is that of the end. Until
  // it is refreshed it tells what a link's mean velocity over the step has more than that.
  void end_sub_steps(double dt);
  se3 drift_of(int link, const Vec3& point) const { return factor_.twist_at(link, point); }

  // --- where nothing can meet it (remote.cpp): q and v go on; what follows from them waits for
  // refresh()
  bool can_be_remote = false, remote = false;
  collide::Bounds remote_box;  // of all its links, with how far they may slide
  void set_remote(const collide::Bounds& box);
  // At most how far a link has slid since, and slides in h more [m].
  double slides_since_remote(double h) const;

  bool in_range() const;
  // Of what the step's forces have added to the velocities, a share, as far as that made them
  // faster.
  void take_back_forces(double fraction);

  // Where it was when the step began, at rest.
  void mark_start() {
    start_q_ = q;
    reactions_.begin_step(v);
    std::fill(forced_.begin(), forced_.end(), 0.0);
  }
  void return_to_start();

  // --- what its joints did in the last step (joint_reactions.h)
  // An impulse on a link in the step that is going on, that is not of its joints; world frame, the
  // moment about the world's origin. Whatever acts on links must be told here.
  void add_external_impulse(int link, const Vec3& impulse, const Vec3& moment) {
    reactions_.add_impulse(link, impulse, moment);
  }
  // Along a degree of freedom, unless it is among its impulses of the whole step.
  void add_effort(std::uint32_t dof, double impulse) { reactions_.add_effort(dof, impulse); }
  void end_step(double dt) {
    if (loaded_) reactions_.note_loads(loads_, joint_loads_);
    reactions_.end_step(dt);
  }
  // Before q or v are set.
  void keep_end_of_step() { reactions_.keep_end(q, v); }
  void forget_step() { reactions_.forget(); }
  // Null: no step is known.
  const JointReactions* reactions();

 private:
  void look_ahead(double h);
  void look_back();
  void update_factor();
  void update_twists();
  void find_lines();
  void find_responses();
  void compare_drives();
  bool stops_are_far(double h) const;
  void update_line_poses();
  se3 twist_in_data(int link, const Vec3& point) const;
  void find_change(double dt, std::span<const double> at);
  void find_force_response();
  void add_loads_of_trees(double dt);
  void add_impulse(int link, double dt);
  void add_joint_impulse(std::uint32_t dof, double dt);
  bool add_forces(double dt, bool& changed);
  void add_damping_efforts(std::span<const double> gained);
  bool add_constant_forces(double dt);
  void advance_floating(double h);

  Model model_;
  Vec3 gravity_;
  Data data_;
  detail::ImpulseFactor factor_;
  std::vector<FloatingTree> floating_;
  std::vector<int> first_dof_;        // of each link, and one more
  std::vector<std::size_t> stopped_;  // degrees of freedom with hard stops
  std::vector<double> damping_;       // of each degree of freedom
  bool damped_ = false;
  bool has_user_joints_ = false;  // only the model's own passes know how they move
  // All joints move along and about one line on which all masses are balanced, and none is damped,
  // as of a table's rods: the mass matrix and the forces of gravity never change, and the
  // velocities make none. One factor serves for ever; data_ is not used, for so few joints its
  // passes' SIMD lanes would be almost empty.
  bool constant_ = false;
  // Then: coordinates along which links slide, and how far for one of it.
  struct Slider {
    std::size_t q, v;
    double slides;
  };
  std::vector<Slider> sliders_;
  // And how far each node has slid along its line and turned about it.
  struct OnLine {
    double slides, turns;  // for one of its own coordinate
    double slide, rotation;
    double sine, cosine;  // of the turn
  };
  std::vector<OnLine> on_line_;         // of each node
  std::vector<SE3> T_world_line_;       // of each link: its line,
  std::vector<SE3> T_line_link_;        // and where it is on that at zero coordinates
  std::vector<std::uint8_t> is_plain_;  // that is a way along the line, without a rotation
  bool keeps_twists_ = false;           // all are
  // What a unit impulse of each motor gives its own coordinate; empty: joints feel one another, or
  // have more than motors and stops.
  std::vector<double> responses_;
  // Then of each velocity: its drive and response are those of the one before it.
  std::vector<std::uint8_t> driven_alike_;
  bool drives_are_compared_ = false;
  enum class Factored : std::uint8_t { no, without_damping, for_the_step };
  Factored factored_ = Factored::no;  // of this configuration
  double factored_time_ = 0.0;        // for how long, for the step
  bool inertias_ = false;             // the factor has them of this configuration
  bool twists_ = false;               // it has the links' velocities, else the data
  bool regular_ = false;
  bool loaded_ = false;
  std::vector<dse3> loads_;          // of each link
  std::vector<double> joint_loads_;  // of each degree of freedom
  std::vector<int> floating_of_;     // of each link: the tree that it is of, or -1
  JointReactions reactions_;

  // Scratch.
  std::vector<double> moving_, drift_;  // sub-steps: v as it moves; mean velocity less v
  std::vector<double> forced_;          // what the forces of this step have added to v
  std::vector<double> start_q_, moved_q_, rate_, change_, force_, zero_, impulse_applied_,
      velocity_, shift_;
  std::vector<double> remote_q_;
  std::vector<CompositeBody> composites_;
  std::vector<double> fall_;  // the acceleration of a constant one
};

}  // namespace vp
