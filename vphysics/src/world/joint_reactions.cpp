// Newton-Euler equations over a whole step, for a link and its subtree:
//
//   dt F = P1 - P0 - dt m g - sum p
//   dt M = L1 - L0 - dt h x g - sum (x - o) x p
//
//   F, M   mean force and moment of the link's joint on the link over the step; M about o, the
//          link's origin
//   P, L   linear momentum, and angular momentum about o in a frame that moves at the mean velocity
//          of o, u = (o1 - o0) / dt: L = sum of I w + m (c - o) x (v - u);  h = sum m (c - o)
//   p, x   external impulses (contacts, the user's forces) and their points; o at the time of the
//          impulse
//
// So F agrees to rounding with the velocities that the world reports. M does not depend on the
// overall velocity or position of the system. The joint's origin is assumed to move on a straight
// line within the step. In free flight the sums of a floating tree conserve its momentum as the
// step does (floating_tree.h), so the reaction of its root is zero. Gravity acts where the step
// applies it: at the poses of its start, or of the starts of its sub-steps.
#include "world/joint_reactions.h"

#include <algorithm>

#include "multibody/tree.h"
#include "vphysics/assert.h"
#include "world/floating_tree.h"
#include "world/impl.h"

namespace vp {

JointReactions::JointReactions(const Model& model)
    : start_v_(static_cast<std::size_t>(model.velocities())),
      end_q_(static_cast<std::size_t>(model.coordinates())),
      end_v_(start_v_.size()),
      external_(static_cast<std::size_t>(model.links())),
      efforts_(start_v_.size()),
      loads_(external_.size()),
      joint_loads_(start_v_.size()) {}

JointReactions::Work::Work(const Model& model)
    : data(model, Arithmetic::reproducible),
      sums(static_cast<std::size_t>(model.links())),
      reactions(sums.size()),
      efforts(static_cast<std::size_t>(model.velocities())) {
  for (std::vector<Pose>& p : poses) p.resize(sums.size());
}

void JointReactions::forget_impulses() {
  std::fill(external_.begin(), external_.end(), External{});
  std::fill(efforts_.begin(), efforts_.end(), 0.0);
  has_external_ = has_efforts_ = false;
}

void JointReactions::add_impulse(int link, const Vec3& impulse, const Vec3& moment) {
  External& sum = external_[static_cast<std::size_t>(link)];
  sum.impulse += impulse;
  sum.moment += moment;
  sum.delay += time_ * impulse;
  has_external_ = true;
}

void JointReactions::note_loads(std::span<const dse3> of_links, std::span<const double> of_joints) {
  std::copy(of_links.begin(), of_links.end(), loads_.begin());
  std::copy(of_joints.begin(), of_joints.end(), joint_loads_.begin());
  has_loads_ = true;
}

void JointReactions::keep_end(std::span<const double> q, std::span<const double> v) {
  if (!knows_step() || found_ || end_is_cached_) return;
  std::copy(q.begin(), q.end(), end_q_.begin());
  std::copy(v.begin(), v.end(), end_v_.begin());
  end_is_cached_ = true;
}

void JointReactions::find_efforts(const Step& step) {
  for (std::size_t i = 0; i < efforts_.size(); ++i) {
    const double load = has_loads_ ? joint_loads_[i] : 0.0;
    work_->efforts[i] = load + (1.0 / step_) * (step.dof_impulses[i] + efforts_[i]);
  }
}

void JointReactions::find_poses(const Model& model, std::span<const double> q,
                                std::span<const double> v, std::vector<Pose>& poses) {
  forward_kinematics<double>(model, work_->data, q, v);
  for (std::size_t l = 0; l < poses.size(); ++l) {
    const int link = static_cast<int>(l);
    const SE3 T = T_world_link(model, work_->data, link);
    const se3 V = link_velocity(model, work_->data, link);
    poses[l] = {T, T.rotate(V.w), T.rotate(V.v)};
  }
}

// Adds the link's own mass, momenta and external impulses, about a point of the world.
void JointReactions::add_self(const Model& model, int link, const Vec3& about, Sum& sum) const {
  const auto l = static_cast<std::size_t>(link);
  const Inertia& J = model.link(link).inertia;
  sum.mass += J.mass();
  for (int k = 0; k < 2; ++k) {
    const auto& [T, w, v] = work_->poses[k][l];
    const Vec3 at = T.position() - about;
    const dse3 momentum = J * se3{T.unrotate(w), T.unrotate(v)};
    const Vec3 linear = T.rotate(momentum.f);
    sum.first_moment[k] += T.rotate(J.first_moment()) + J.mass() * at;
    sum.linear[k] += linear;
    sum.angular[k] += T.rotate(momentum.m) + cross(at, linear);
  }
  if (has_external_) {
    const External& own = external_[l];
    sum.external.impulse += own.impulse;
    sum.external.moment += own.moment - cross(about, own.impulse);
    sum.external.delay += own.delay;
  }
  if (has_loads_) {
    const Vec3 from = work_->poses[0][l].T.position(), to = work_->poses[1][l].T.position();
    const double time = acting_ / step_;
    const Vec3 at = from + (time / step_) * (to - from) - about;
    const Vec3 impulse = step_ * loads_[l].f;
    sum.external.impulse += impulse;
    sum.external.moment += step_ * loads_[l].m + cross(at, impulse);
    sum.external.delay += time * impulse;
  }
}

// from, to: the link's origin at the start and the end of the step.
JointForce JointReactions::reaction(const Sum& sum, const Vec3& from, const Vec3& to,
                                    const Vec3& gravity) const {
  const Vec3 u = (1.0 / step_) * (to - from);
  const Vec3 h[2] = {sum.first_moment[0] - sum.mass * from, sum.first_moment[1] - sum.mass * to};
  const Vec3 L[2] = {sum.angular[0] - cross(from, sum.linear[0]) - cross(h[0], u),
                     sum.angular[1] - cross(to, sum.linear[1]) - cross(h[1], u)};
  const Vec3 h_acting = h[0] + (acting_ / (step_ * step_)) * (h[1] - h[0]);
  const External& other = sum.external;
  const Vec3 impulse = sum.linear[1] - sum.linear[0] - (step_ * sum.mass) * gravity - other.impulse;
  const Vec3 moment = L[1] - L[0] - step_ * cross(h_acting, gravity) -
                      (other.moment - cross(from, other.impulse) - cross(u, other.delay));
  return {(1.0 / step_) * impulse, (1.0 / step_) * moment};
}

// The root joint has no constraint. Its efforts act in the link's frame at the start of the step.
JointForce JointReactions::of_floating_root(const Model& model, int link) const {
  const double* f = work_->efforts.data() + model.first_velocity(link);
  const SE3& T = work_->poses[0][static_cast<std::size_t>(link)].T;
  return {T.rotate({f[3], f[4], f[5]}), T.rotate({f[0], f[1], f[2]})};
}

void JointReactions::find(const Model& model, const Step& step) {
  found_ = true;
  if (!work_) work_ = std::make_unique<Work>(model);
  Work& work = *work_;
  const std::span<const double> q = end_is_cached_ ? end_q_ : step.q;
  const std::span<const double> v = end_is_cached_ ? end_v_ : step.v;
  find_efforts(step);
  find_poses(model, step.start_q, start_v_, work.poses[0]);
  find_poses(model, q, v, work.poses[1]);
  const Vec3 about = work.poses[0].front().T.position();
  std::fill(work.sums.begin(), work.sums.end(), Sum{});
  for (int link = model.links(); link-- > 0;) {
    const auto l = static_cast<std::size_t>(link);
    Sum& sum = work.sums[l];
    add_self(model, link, about, sum);
    const LinkSpec& spec = model.link(link);
    const bool is_root = spec.parent == kWorld && floats(model, model.tree().frames[l].node);
    work.reactions[l] = is_root ? of_floating_root(model, link)
                                : reaction(sum, work.poses[0][l].T.position() - about,
                                           work.poses[1][l].T.position() - about, step.gravity);
    if (spec.parent == kWorld) continue;
    Sum& parent = work.sums[static_cast<std::size_t>(spec.parent)];
    parent.mass += sum.mass;
    for (int k = 0; k < 2; ++k) {
      parent.first_moment[k] += sum.first_moment[k];
      parent.linear[k] += sum.linear[k];
      parent.angular[k] += sum.angular[k];
    }
    parent.external.impulse += sum.external.impulse;
    parent.external.moment += sum.external.moment;
    parent.external.delay += sum.external.delay;
  }
}

Vec3 JointReactions::acceleration(int link, const Vec3& point) const {
  const auto l = static_cast<std::size_t>(link);
  const auto velocity = [&](const Pose& pose) {
    return pose.v + cross(pose.w, pose.T.rotate(point));
  };
  return (1.0 / step_) * (velocity(work_->poses[1][l]) - velocity(work_->poses[0][l]));
}

JointForce World::joint_reaction(ArticulationId id, int link) const {
  Articulation* art = impl_->find(id);
  const bool has = art && link >= 0 && link < art->model().links();
  VP_ASSERT(has && "joint_reaction: no such link");
  const JointReactions* found = has ? art->reactions() : nullptr;
  return found ? found->of(link) : JointForce{};
}

double World::joint_effort(ArticulationId id, int link, int dof) const {
  Articulation* art = impl_->find(id);
  const int i = art ? art->dof_index(link, dof) : -1;
  VP_ASSERT(i >= 0 && "joint_effort: no such degree of freedom");
  const JointReactions* found = i >= 0 ? art->reactions() : nullptr;
  return found ? found->effort(static_cast<std::size_t>(i)) : 0.0;
}

Vec3 World::acceleration_at(BodyId id, const Vec3& point) const {
  const Body* body = impl_->find(id);
  const bool has = body && body->is_link;
  VP_ASSERT(has && "acceleration_at: the body is not a link of an articulation (any more)");
  if (!has) return {};
  Articulation& art = impl_->articulations[body->articulation];
  impl_->update_if_remote(art);
  const Vec3 in_link = inverse_times(art.T_world_link(body->link), point);
  const JointReactions* found = art.reactions();
  return found ? found->acceleration(body->link, in_link) : Vec3{};
}

}  // namespace vp
