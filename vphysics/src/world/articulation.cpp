// One step of an articulation, in joint coordinates:
//
//   v += (M + dt D)^-1 dt (f - h(q, v) - D v)   h: gravity, Coriolis and centrifugal; D: damping;
//                                               f: the user's forces, on joints and through J^T
//   v += H^T z                                  impulses of the solver (impulse_factor.h)
//   q  = q [+] dt v                             on the group; configuration.h
//
// Velocity-dependent forces are evaluated at the midpoint v + dv / 2; otherwise a spinning tree
// would gain energy. A floating tree also conserves its momentum (floating_tree.h).
#include "world/articulation.h"

#include <algorithm>
#include <cmath>

#include "multibody/kinematics.h"
#include "vphysics/multibody/configuration.h"
#include "world/solver_limits.h"
#include "world/validate.h"

namespace vp {
namespace {

using detail::NodeKind;

// A joint approaches its motor's target ever more slowly, and after some seconds would compute with
// denormal numbers, which take a hundred times as long as others. Below this speed [m/s], [rad/s]
// it is set to rest: in the age of the universe it would move less than an atom's size.
constexpr double kRestSpeed = 1e-28;
double flush_small_speed(double speed) {
  return std::fabs(speed) < kRestSpeed ? 0.0 : speed;
}

// The node's joint moves about or along its parent's axis, and its mass is balanced on that axis.
bool continues_axis(const detail::Node<double>& node) {
  constexpr double kTolerance = 1e-12;  // rounding in the composition of the joints' frames
  const auto along_z = [&](const Vec3& a, double scale) {
    return std::fabs(a.x) <= kTolerance * scale && std::fabs(a.y) <= kTolerance * scale;
  };
  return node.kind <= NodeKind::helical && along_z(node.J.first_moment(), node.J.mass()) &&
         (node.parent == kWorld ||
          (along_z(node.T_parent.rotation().cz, 1.0) && along_z(node.T_parent.position(), 1.0)));
}

// Index of the floating tree of a link, or -1.
int tree_of(const Model& model, const std::vector<FloatingTree>& floating, int link) {
  int node = model.tree().frames[static_cast<std::size_t>(link)].node;
  if (node == kWorld) return -1;
  for (int parent = node; parent != kWorld;) {
    node = parent;
    parent = model.tree().nodes[static_cast<std::size_t>(node)].parent;
  }
  const auto is_root = [node](const FloatingTree& tree) { return tree.root() == node; };
  const auto found = std::find_if(floating.begin(), floating.end(), is_root);
  return found == floating.end() ? -1 : static_cast<int>(found - floating.begin());
}

bool has_coordinate(const Joint& joint) {
  return !std::holds_alternative<BallJoint>(joint) && !std::holds_alternative<FreeJoint>(joint);
}

}  // namespace

Articulation::Articulation(const Model& model, const Vec3& gravity)
    : q(model.zero_coordinates()),
      model_(model),
      gravity_(gravity),
      data_(model, Arithmetic::reproducible),
      factor_(model),
      floating_(FloatingTree::of(model)),
      implicit_(static_cast<std::size_t>(model.velocities())),
      reactions_(model) {
  const auto n = static_cast<std::size_t>(model.velocities());
  v.resize(n);
  dofs.resize(n);
  for (std::vector<double>* scratch :
       {&damping_, &forced_, &sub_step_velocity_, &drift_, &rate_, &change_, &last_change_, &force_,
        &zero_, &applied_forces_, &velocity_, &shift_}) {
    scratch->resize(n);
  }
  composites_.resize(floating_.size());
  joint_loads_.resize(n);
  loads_.resize(static_cast<std::size_t>(model.links()));
  for (int l = 0; l < model.links(); ++l) floating_of_.push_back(tree_of(model, floating_, l));
  for (int l = 0; l < model.links(); ++l) {
    const LinkSpec& link = model.link(l);
    const auto first = static_cast<std::size_t>(model.first_velocity(l));
    first_dof_.push_back(model.first_velocity(l));
    for (int k = 0; k < velocities_of(link.joint); ++k) {
      const std::size_t i = first + static_cast<std::size_t>(k);
      damping_[i] = link.damping;
      damped_ = damped_ || link.damping > 0.0;
      JointDof& dof = dofs[i];
      if (!link.forces.empty()) dof.forces = link.forces[static_cast<std::size_t>(k)];
      const bool is_compliant = std::isfinite(dof.forces.limit_stiffness);
      dof.locked = std::isinf(dof.forces.friction);
      dof.passive = dof.forces.friction > 0.0 || dof.forces.stiffness > 0.0 || is_compliant;
      if (!has_coordinate(link.joint)) continue;
      dof.coordinate = model.first_coordinate(l) + k;
      if (is_compliant) continue;
      dof.lower = std::max(dof.lower, dof.forces.lower);
      dof.upper = std::min(dof.upper, dof.forces.upper);
      if (std::isfinite(dof.forces.lower) || std::isfinite(dof.forces.upper)) stopped_.push_back(i);
      double& start = q[static_cast<std::size_t>(dof.coordinate)];
      start = std::clamp(start, dof.lower, dof.upper);
    }
  }
  first_dof_.push_back(model.velocities());
  for (const FloatingTree& tree : floating_) {  // their roots have no forces of their own
    const auto& root = model.tree().nodes[static_cast<std::size_t>(tree.root())];
    for (int k = 0; k < root.dofs; ++k) implicit_.exclude(static_cast<std::size_t>(root.v + k));
  }
  start_v_ = v;
  start_q_ = moved_q_ = remote_q_ = q;
  const auto& nodes = model.tree().nodes;
  has_user_joints_ = std::any_of(nodes.begin(), nodes.end(), [](const auto& node) {
    return node.kind == detail::NodeKind::user;
  });
  constant_ = !damped_ && std::all_of(nodes.begin(), nodes.end(), continues_axis);
  forward_kinematics<double>(model_, data_, q, v);
  regular_ = factor_.factor(model_, data_);
  factored_ = Factored::without_damping;
  factor_.twists(zero_);
  find_change(1.0, zero_);
  gravity_acceleration_ = change_;
  if (constant_) {
    find_lines();
    find_responses();
  }
  refresh();
}

void Articulation::refresh() {
  if (constant_) {
    update_line_poses();
    update_twists();
    return;
  }
  forward_kinematics<double>(model_, data_, q, v);
  factored_ = Factored::no;
  twists_ = inertias_ = false;
}

// A joint whose axis is opposite to its line slides and rotates backwards.
void Articulation::find_lines() {
  const auto& nodes = model_.tree().nodes;
  const std::vector<double> zero(q.size(), 0.0);
  forward_kinematics<double>(model_, data_, zero, {});
  std::vector<SE3> line(nodes.size());
  for (std::size_t i = 0; i < nodes.size(); ++i) {
    const auto& node = nodes[i];
    line[i] = node.parent == kWorld ? node.T_parent : line[static_cast<std::size_t>(node.parent)];
    const Vec3 z = detail::pose_of(data_.work(), static_cast<int>(i)).rotation().cz;
    const double displacement = dot(z, line[i].rotation().cz) > 0.0 ? 1.0 : -1.0;
    const bool turns = node.kind != NodeKind::prismatic;
    on_line_.push_back({.slides = turns ? displacement * node.pitch : displacement,
                        .turns = turns ? displacement : 0.0,
                        .slide = 0.0,
                        .rotation = 0.0,
                        .sine = 0.0,
                        .cosine = 1.0});
    if (on_line_.back().slides != 0.0) {
      sliders_.push_back({static_cast<std::size_t>(node.q), static_cast<std::size_t>(node.v),
                          std::fabs(on_line_.back().slides)});
    }
  }
  for (int l = 0; l < model_.links(); ++l) {
    const int node = model_.tree().frames[static_cast<std::size_t>(l)].node;
    const SE3 T = vp::T_world_link(model_, data_, l);
    T_world_line_.push_back(node == kWorld ? T : line[static_cast<std::size_t>(node)]);
    T_line_link_.push_back(Inv(T_world_line_.back()) * T);
    const SE3& X = T_line_link_.back();
    const bool plain = X.rotation().cx == Vec3{1, 0, 0} && X.rotation().cy == Vec3{0, 1, 0} &&
                       X.rotation().cz == Vec3{0, 0, 1} && X.position().x == 0.0 &&
                       X.position().y == 0.0;
    is_axial_.push_back(node != kWorld && plain ? 1 : 0);
  }
  keeps_twists_ = std::all_of(is_axial_.begin(), is_axial_.end(), [](auto p) { return p != 0; });
}

void Articulation::find_responses() {
  for (std::size_t i = 0; i < v.size(); ++i) {
    const auto dof = static_cast<std::uint32_t>(i);
    const auto row = factor_.joint_row(dof);
    const bool is_coupled = std::any_of(row.y + 1, row.y + factor_.depth_of_dof(dof),
                                        [](double y) { return y != 0.0; });
    if (is_coupled || dofs[i].passive || dofs[i].locked || gravity_acceleration_[i] != 0.0) {
      responses_.clear();
      return;
    }
    responses_.push_back(row.response);
  }
  same_drive_as_previous_.assign(v.size(), 0);
}

// All stops are so far that none gets a row (add_stops(), row_solve.cpp).
bool Articulation::stops_are_inactive(double h) const {
  for (const std::size_t i : stopped_) {
    const JointDof& dof = dofs[i];
    const double x = q[static_cast<std::size_t>(dof.coordinate)];
    const double range = stop_range(h, v[i]);
    if (dof.lower - x > -range || dof.upper - x < range) return false;
  }
  return true;
}

void Articulation::compare_drives() {
  drives_are_compared_ = true;
  for (std::size_t i = 1; i < v.size(); ++i) {
    same_drive_as_previous_[i] = responses_[i] == responses_[i - 1] &&
                                 dofs[i].drive == dofs[i - 1].drive &&
                                 dofs[i].forces.motor_limit == dofs[i - 1].forces.motor_limit;
  }
}

// p = constant - gain (v + response p). Neighbours with equal state and drive have equal impulses,
// computed once. There is one coordinate for each velocity (constant_).
bool Articulation::solve_decoupled(double h) {
  if (responses_.empty() || !stops_are_inactive(h)) return false;
  if (!drives_are_compared_) compare_drives();
  double impulse = 0.0, x_before = 0.0, v_before = 0.0, v_after = 0.0;
  const std::size_t n = v.size();
  for (std::size_t i = 0; i < n; ++i) {
    JointDof& dof = dofs[i];
    const double x = q[i], speed = v[i];
    const bool alike = same_drive_as_previous_[i] && speed == v_before && x == x_before;
    if (!alike) {
      x_before = x;
      v_before = speed;
      const Motor motor = motor_of(dof, h, x);
      const double p = (motor.constant - motor.gain * speed) / (1.0 + motor.gain * responses_[i]);
      impulse = std::clamp(p, -motor.limit, motor.limit);
      v_after = flush_small_speed(speed + responses_[i] * impulse);
    }
    dof.impulses = {impulse};
    v[i] = v_after;
  }
  if (!remote) update_twists();
  return true;
}

void Articulation::set_remote(const collide::Bounds& box) {
  remote = true;
  remote_box = box;
  remote_q_ = q;
}

double Articulation::slides_since_remote(double h) const {
  double sum = 0.0;
  for (const Slider& s : sliders_) {
    sum += s.slides * (std::fabs(q[s.q] - remote_q_[s.q]) + h * std::fabs(v[s.v]));
  }
  return sum;
}

Vec3 Articulation::line_of(int link) const {
  const auto l = static_cast<std::size_t>(link);
  return constant_ && is_axial_[l] ? T_world_line_[l].rotation().cz : Vec3{};
}

void Articulation::update_line_poses() {
  const auto& nodes = model_.tree().nodes;
  for (std::size_t i = 0; i < nodes.size(); ++i) {
    const auto& node = nodes[i];
    const double x = q[static_cast<std::size_t>(node.q)];
    OnLine& on = on_line_[i];
    on.slide = on.slides * x;
    on.rotation = on.turns * x;
    if (node.parent == kWorld) continue;
    on.slide += on_line_[static_cast<std::size_t>(node.parent)].slide;
    on.rotation += on_line_[static_cast<std::size_t>(node.parent)].rotation;
  }
  // Neighbours often rotate equally: compute sine and cosine once.
  const OnLine* last = nullptr;
  for (OnLine& on : on_line_) {
    if (on.rotation == 0.0) {
      on.sine = 0.0;
      on.cosine = 1.0;
      continue;
    }
    if (!last || on.rotation != last->rotation) {
      const auto [s, c] = sin_cos(on.rotation);
      on.sine = s;
      on.cosine = c;
    } else {
      on.sine = last->sine;
      on.cosine = last->cosine;
    }
    last = &on;
  }
}

SE3 Articulation::T_world_link(int link) const {
  if (!constant_) return vp::T_world_link(model_, data_, link);
  const auto l = static_cast<std::size_t>(link);
  const int node = model_.tree().frames[l].node;
  const SE3& X = T_world_line_[l];
  if (node == kWorld) return X;
  const OnLine& on = on_line_[static_cast<std::size_t>(node)];
  const double s = on.sine, c = on.cosine;
  const Mat3& R = X.rotation();
  const SE3 moved(Mat3{c * R.cx + s * R.cy, c * R.cy - s * R.cx, R.cz},
                  X.position() + on.slide * R.cz);
  if (!is_axial_[l]) return moved * T_line_link_[l];
  return SE3(moved.rotation(), moved.position() + T_line_link_[l].position().z * R.cz);
}

// The factor without damping. Damping belongs only to forces that act during the step.
void Articulation::update_factor() {
  const bool is_of_masses_alone =
      factored_ == Factored::without_damping ||
      (factored_ == Factored::for_the_step && !damped_ && !implicit_.any());
  if (is_of_masses_alone) return;
  (void)factor_.factor(model_, data_, 0.0, inertias_);
  inertias_ = true;
  factored_ = Factored::without_damping;
}

void Articulation::update_twists() {
  factor_.twists(v);
  twists_ = true;
}

se3 Articulation::twist_in_data(int link, const Vec3& p) const {
  const int node = model_.tree().frames[static_cast<std::size_t>(link)].node;
  if (node == kWorld) return {};
  const se3 V = detail::velocity_of(data_.work(), node);
  return {V.w, V.v + cross(V.w, p - detail::origin_of(data_.work(), node))};
}

void Articulation::advance(double h) {
  reactions_.pass(h);
  if (sub_stepped) {
    for (std::size_t i = 0; i < v.size(); ++i) rate_[i] = h * (v[i] + drift_[i]);
    integrate<double>(model_, q, rate_, q);
    refresh();
    return;
  }
  if (constant_) {  // one coordinate per velocity; the twists do not change
    for (std::size_t i = 0; i < v.size(); ++i) q[i] += h * v[i];
    if (!remote) update_line_poses();
    return;
  }
  if (!floating_.empty()) return advance_floating(h);
  for (std::size_t i = 0; i < v.size(); ++i) rate_[i] = h * v[i];
  integrate<double>(model_, q, rate_, q);
  refresh();
}

// Updates only the poses, until restore_poses().
void Articulation::predict_poses(double h) {
  for (std::size_t i = 0; i < v.size(); ++i) rate_[i] = h * v[i];
  moved_q_ = q;
  if (constant_) {
    for (std::size_t i = 0; i < v.size(); ++i) q[i] += rate_[i];
    update_line_poses();
    return;
  }
  integrate<double>(model_, moved_q_, rate_, q);
  forward_kinematics<double>(model_, data_, q, v);
}
void Articulation::restore_poses() {
  q = moved_q_;
  if (constant_) return update_line_poses();
  forward_kinematics<double>(model_, data_, q, v);
}

// The root moves at the velocity that it will have at the midpoint, where its momentum equals the
// current one.
void Articulation::advance_floating(double h) {
  if (factored_ == Factored::no) update_factor();
  if (!twists_) factor_.twists(v);
  for (std::size_t i = 0; i < floating_.size(); ++i) {
    composites_[i] = floating_[i].composite_of_twists(data_, factor_);
  }
  for (std::size_t i = 0; i < v.size(); ++i) rate_[i] = 0.5 * h * v[i];
  integrate<double>(model_, q, rate_, moved_q_);
  forward_kinematics<double>(model_, data_, moved_q_, v);
  factor_.find_inertias(model_, data_);
  rate_ = v;
  for (std::size_t i = 0; i < floating_.size(); ++i) {
    const CompositeBody now = floating_[i].composite(data_, factor_);
    floating_[i].set_momentum(model_, data_, now, composites_[i], rate_);
  }
  for (double& r : rate_) r *= h;
  integrate<double>(model_, q, rate_, q);
  refresh();
  factor_.find_inertias(model_, data_);
  inertias_ = true;
  for (std::size_t i = 0; i < floating_.size(); ++i) {
    const CompositeBody &from = composites_[i], now = floating_[i].composite(data_, factor_);
    const Vec3 centre = from.centre + (h / from.mass) * from.linear;
    floating_[i].shift(model_, centre - now.centre, q);
    floating_[i].set_momentum(model_, data_, now, from, v);
  }
  // To the same bits as refresh(), as of a state that has been restored.
  if (has_user_joints_) return refresh();
  detail::ImpulseFactor::kinematics_of(model_, data_, q, v);
}

void Articulation::store_sub_step_velocity() {
  change_ = velocity_;
  factor_.to_velocities(change_);
  for (std::size_t i = 0; i < v.size(); ++i) sub_step_velocity_[i] = v[i] + change_[i];
}

void Articulation::advance_sub_step(double h) {
  for (std::size_t i = 0; i < v.size(); ++i) change_[i] = v[i] - sub_step_velocity_[i];
  velocity_ = change_;  // advance() uses the other scratch vectors
  v = sub_step_velocity_;
  twists_ = false;
  sub_stepped = false;
  advance(h);
  sub_stepped = true;
  for (std::size_t i = 0; i < v.size(); ++i) v[i] += velocity_[i];
  refresh();
}

void Articulation::end_sub_steps(double dt) {
  reactions_.back_to_start();
  difference<double>(model_, start_q_, q, rate_);
  for (std::size_t i = 0; i < v.size(); ++i) drift_[i] = rate_[i] / dt - v[i];
  q = start_q_;
  refresh();
  update_factor();
  factor_.twists(drift_);
}

solve::SolverArticulation Articulation::begin_solve(bool whole_step) {
  if (!whole_step || factored_ != Factored::for_the_step) update_factor();
  std::fill(velocity_.begin(), velocity_.end(), 0.0);
  std::fill(shift_.begin(), shift_.end(), 0.0);
  changes_are_found_ = false;
  return {&factor_, velocity_.data(), shift_.data(), false};
}

Articulation::Change Articulation::end_solve() {
  const auto pushed = [](const std::vector<double>& z) {
    return std::any_of(z.begin(), z.end(), [](double x) { return x != 0.0; });
  };
  const bool moved = pushed(shift_);
  if (!moved && !pushed(velocity_)) return Change::none;
  if (!changes_are_found_) factor_.to_velocities(velocity_);
  for (std::size_t i = 0; i < v.size(); ++i) v[i] = flush_small_speed(v[i] + velocity_[i]);
  if (damped_ && factored_ == Factored::for_the_step) add_damping_efforts(velocity_);
  if (!moved) {
    update_twists();
    return Change::of_velocities;
  }
  factor_.to_velocities(shift_);
  for (std::size_t i = 0; i < v.size(); ++i) {
    const JointDof& dof = dofs[i];
    if (dof.coordinate < 0) continue;
    const double now = q[static_cast<std::size_t>(dof.coordinate)];
    shift_[i] =
        std::clamp(shift_[i], std::min(0.0, dof.lower - now), std::max(0.0, dof.upper - now));
  }
  integrate<double>(model_, q, shift_, q);
  refresh();
  return Change::of_coordinates_too;
}

bool Articulation::apply_impulse(int link, const Vec3& impulse, const Vec3& point) {
  update_factor();
  factor_.force_row(link, point, impulse, rate_.data());
  std::fill(change_.begin(), change_.end(), 0.0);
  std::uint32_t d = factor_.first(link);
  for (std::uint32_t k = 0; k < factor_.depth(link); ++k, d = factor_.next()[d]) {
    change_[d] = rate_[k];
  }
  factor_.to_velocities(change_);
  for (std::size_t i = 0; i < v.size(); ++i) {
    if (!vp::in_range(v[i] + change_[i])) return false;
  }
  keep_end_of_step();
  for (std::size_t i = 0; i < v.size(); ++i) v[i] += change_[i];
  refresh();
  return true;
}

const JointReactions* Articulation::reactions() {
  if (!reactions_.knows_step()) return nullptr;
  if (reactions_.is_found()) return &reactions_;
  for (std::size_t i = 0; i < v.size(); ++i) {
    rate_[i] = 0.0;
    if (sub_stepped) continue;  // the impulses are of the last sub-step only
    for (const double impulse : dofs[i].impulses) rate_[i] += impulse;
  }
  reactions_.find(model_, {start_q_, q, v, gravity_, rate_});
  return &reactions_;
}

bool Articulation::in_range() const {
  double squares = 0.0;
  const std::size_t n = v.size();
  for (std::size_t i = 0; i < n; ++i) squares += q[i] * q[i] + v[i] * v[i];
  for (std::size_t i = n; i < q.size(); ++i) squares += q[i] * q[i];
  if (squares <= kLargest * kLargest) return true;
  bool good = true;
  for (const double x : q) good &= vp::in_range(x);
  for (const double x : v) good &= vp::in_range(x);
  return good;
}

void Articulation::return_to_start() {
  reactions_.spoil();
  q = start_q_;
  std::fill(v.begin(), v.end(), 0.0);
  for (JointDof& dof : dofs) dof.impulses = {};
  refresh();
}

}  // namespace vp
