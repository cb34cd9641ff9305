// Joint reactions: the forces of an articulation's joints on their links in the last step.
//
// A step records what cannot be computed afterwards: the velocities at its start, external
// impulses, impulses along the joints. Reactions are computed on request.
#pragma once

#include <memory>
#include <span>
#include <vector>

#include "vphysics/multibody/dynamics.h"
#include "vphysics/world_joints.h"

namespace vp {

class JointReactions {
 public:
  explicit JointReactions(const Model& model);

  // --- during a step
  void begin_step(std::span<const double> v) {
    step_ = time_ = acting_ = 0.0;
    spoiled_ = found_ = end_is_cached_ = has_loads_ = false;
    for (std::size_t i = 0; i < v.size(); ++i) start_v_[i] = v[i];  // few entries: no call
    if (has_external_ || has_efforts_) forget_impulses();
  }
  // Advances the time of the impulses that follow by h.
  void pass(double h) { time_ += h; }
  void back_to_start() { time_ = 0.0; }
  // Gravity and the user's forces act for h, at the current poses.
  void act(double h) { acting_ += h * time_; }
  // On a link, in the world frame. The moment is about the world's origin.
  void add_impulse(int link, const Vec3& impulse, const Vec3& moment);
  // Along a degree of freedom, besides the joint's impulses in Step::dof_impulses.
  void add_effort(std::size_t dof, double impulse) {
    efforts_[dof] += impulse;
    has_efforts_ = true;
  }
  void note_loads(std::span<const dse3> of_links, std::span<const double> of_joints);
  // The velocities of this step do not follow from its forces any more.
  void spoil() { spoiled_ = true; }
  void end_step(double dt) { step_ = spoiled_ ? 0.0 : dt; }

  // --- between steps
  // Forgets the last step: all results become zero.
  void forget() { step_ = 0.0; }
  // Call it before q or v change from outside a step.
  void keep_end(std::span<const double> q, std::span<const double> v);

  // Data of the step that are not recorded here.
  struct Step {
    std::span<const double> start_q, q, v;  // q and v: current values
    Vec3 gravity;
    std::span<const double> dof_impulses;  // of the whole step
  };
  bool knows_step() const { return step_ > 0.0; }
  bool is_found() const { return found_; }
  void find(const Model& model, const Step& step);
  // Precondition of the functions below: is_found() and knows_step().
  const JointForce& of(int link) const { return work_->reactions[static_cast<std::size_t>(link)]; }
  double effort(std::size_t dof) const { return work_->efforts[dof]; }
  Vec3 acceleration(int link, const Vec3& point) const;  // point in the link's frame

 private:
  void forget_impulses();

  // External impulses, without gravity. delay: the sum of each impulse times its time within the
  // step.
  struct External {
    Vec3 impulse, moment, delay;
  };
  struct Pose {
    SE3 T;
    Vec3 w, v;  // world frame; velocity of the link's origin
  };
  // Sums over a link and its subtree, about one point: [0] at the start of the step, [1] at its
  // end.
  struct Sum {
    double mass = 0.0;
    Vec3 first_moment[2], linear[2], angular[2];
    External external;
  };
  struct Work {
    explicit Work(const Model& model);
    Data data;
    std::vector<Pose> poses[2];
    std::vector<Sum> sums;
    std::vector<JointForce> reactions;  // of each link
    std::vector<double> efforts;        // of each degree of freedom
  };
  void find_efforts(const Step& step);
  void find_poses(const Model& model, std::span<const double> q, std::span<const double> v,
                  std::vector<Pose>& poses);
  void add_self(const Model& model, int link, const Vec3& about, Sum& sum) const;
  JointForce reaction(const Sum& sum, const Vec3& from, const Vec3& to, const Vec3& gravity) const;
  JointForce of_floating_root(const Model& model, int link) const;

  double step_ = 0.0;    // length of the last step; 0: no step is known
  double time_ = 0.0;    // within the step
  double acting_ = 0.0;  // integral of the time at which gravity acts
  bool spoiled_ = false, found_ = false, end_is_cached_ = false;
  bool has_external_ = false, has_efforts_ = false, has_loads_ = false;
  std::vector<double> start_v_, end_q_, end_v_;
  std::vector<External> external_;   // of each link
  std::vector<double> efforts_;      // impulses of each degree of freedom
  std::vector<dse3> loads_;          // of each link
  std::vector<double> joint_loads_;  // of each degree of freedom
  std::unique_ptr<Work> work_;       // null before the first request
};

}  // namespace vp
