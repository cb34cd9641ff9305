// The effect of a step's or sub-step's forces on an articulation's velocities: gravity,
// velocity-dependent forces, the user's forces and viscous joint damping.
#include <algorithm>
#include <cmath>

#include "multibody/kinematics.h"
#include "world/articulation.h"
#include "world/validate.h"

namespace vp {
namespace {

// Half of the angle by which velocity-dependent forces may turn the velocities in a step until one
// evaluation at the midpoint no longer suffices.
constexpr double kSmallTurn = 0.05;

double size_of(std::span<const double> x) {
  double sum = 0.0;
  for (const double each : x) sum += each * each;
  return std::sqrt(sum);
}

}  // namespace

// change_ = (M + dt D)^-1 dt (f - h(q, at) - D v); the factor has the twists of `at`.
void Articulation::find_change(double dt, std::span<const double> at) {
  if (has_user_joints_) {
    inverse_dynamics<double>(model_, data_, q, at, zero_, {.gravity = gravity_}, force_);
    for (std::size_t i = 0; i < v.size(); ++i) force_[i] -= damping_[i] * at[i];
  } else {
    factor_.bias(gravity_, force_);
  }
  for (std::size_t i = 0; i < v.size(); ++i) {
    change_[i] = dt * (applied_forces_[i] - force_[i] - damping_[i] * v[i]);
  }
  if (implicit_.any()) {
    for (std::size_t i = 0; i < v.size(); ++i) change_[i] += implicit_.impulse(i, v[i]);
  }
  factor_.solve(change_);
}

void Articulation::find_change_at_middle(double dt) {
  for (std::size_t i = 0; i < v.size(); ++i) rate_[i] = v[i] + 0.5 * change_[i];
  if (!has_user_joints_) factor_.twists(rate_);
  find_change(dt, rate_);
}

// The change whose velocity-dependent forces are those at v + change / 2. change_ is that at v. One
// evaluation suffices unless the velocities change far within the sub-step by these forces: fast
// rotation would then gain energy. The iterations are damped for forces that rotate the velocities,
// as gyroscopic ones do; `turn` is half of the angle.
void Articulation::find_midpoint_change(double dt) {
  constexpr double kConverged = 1e-4;
  constexpr int kMaxIterations = 12;
  const double size = size_of(change_);
  last_change_ = change_;
  double turn = 0.0, relaxation = 1.0;
  for (int i = 0; i < kMaxIterations; ++i) {
    find_change_at_middle(dt);
    for (std::size_t k = 0; k < v.size(); ++k) last_change_[k] = change_[k] - last_change_[k];
    const double error = size_of(last_change_);
    if (i == 0) {
      turn = error / size;
      if (!(turn > kSmallTurn)) return;
      relaxation = 1.0 / (1.0 + turn * turn);
    }
    if (error <= kConverged * size) return;
    for (std::size_t k = 0; k < v.size(); ++k) change_[k] -= (1.0 - relaxation) * last_change_[k];
    last_change_ = change_;
  }
  // Too fast for a sub-step: without these forces.
  if (!has_user_joints_) factor_.twists(zero_);
  find_change(dt, zero_);
}

bool Articulation::turns_far(double dt) {
  constexpr double kFast =
      0.15;  // rotation of a link in a step [rad]: slower ones are not examined
  if (constant_) return false;
  double fastest = 0.0;
  for (int l = 0; l < model_.links(); ++l) {
    const Vec3 w = link_velocity(l, {}).w;
    fastest = std::max(fastest, dot(w, w));
  }
  if (!(dt * dt * fastest > kFast * kFast)) return false;
  update_factor();
  factor_.twists(v);
  implicit_.clear();
  find_change(dt, v);
  last_change_ = change_;
  find_change_at_middle(dt);
  const double size = size_of(last_change_);
  for (std::size_t i = 0; i < v.size(); ++i) change_[i] -= last_change_[i];
  update_twists();
  return size_of(change_) > kSmallTurn * size;
}

void Articulation::clear_loads() {
  if (!loaded_) return;
  loaded_ = false;
  std::fill(loads_.begin(), loads_.end(), dse3{});
  std::fill(joint_loads_.begin(), joint_loads_.end(), 0.0);
  std::fill(applied_forces_.begin(), applied_forces_.end(), 0.0);
}

// All the user's forces as joint forces.
void Articulation::find_force_response() {
  applied_forces_ = joint_loads_;
  for (std::size_t l = 0; l < loads_.size(); ++l) {
    if (loads_[l] == dse3{}) continue;
    const int link = static_cast<int>(l);
    factor_.add_load(link, T_world_link(link).position(), loads_[l], applied_forces_);
  }
}

// Adds to the momentum of floating trees the impulse of the user's forces: those on links, and
// those of the root joint, which are in its frame.
void Articulation::add_loads_of_trees(double dt) {
  const auto add = [&](CompositeBody& tree, const Vec3& at, const dse3& load) {
    tree.linear += dt * load.f;
    tree.angular += dt * (load.m + cross(at - tree.centre, load.f));
  };
  for (std::size_t l = 0; l < loads_.size(); ++l) {
    if (floating_of_[l] < 0 || loads_[l] == dse3{}) continue;
    const SE3 T = T_world_link(static_cast<int>(l));
    add(composites_[static_cast<std::size_t>(floating_of_[l])], T.position(), loads_[l]);
  }
  for (std::size_t i = 0; i < floating_.size(); ++i) {
    const int root = floating_[i].root();
    const Mat3 R = detail::pose_of(data_.work(), root).rotation();
    const double* f = joint_loads_.data() + model_.tree().nodes[static_cast<std::size_t>(root)].v;
    const CompositeBody& tree = composites_[i];
    add(composites_[i], tree.root, {R * Vec3{f[0], f[1], f[2]}, R * Vec3{f[3], f[4], f[5]}});
  }
}

bool Articulation::add_constant_forces(double dt) {
  bool falls = false;
  for (std::size_t i = 0; i < v.size(); ++i) {
    v[i] += dt * gravity_acceleration_[i];
    falls = falls || gravity_acceleration_[i] != 0.0;
  }
  if (loaded_) {
    std::fill(velocity_.begin(), velocity_.end(), 0.0);
    for (std::size_t l = 0; l < loads_.size(); ++l) add_impulse(static_cast<int>(l), dt);
    for (std::size_t i = 0; i < v.size(); ++i) {
      if (joint_loads_[i] != 0.0) add_joint_impulse(static_cast<std::uint32_t>(i), dt);
    }
    factor_.to_velocities(velocity_);
    for (std::size_t i = 0; i < v.size(); ++i) v[i] += velocity_[i];
    falls = true;
  }
  if (falls) update_twists();
  return falls;
}

// Adds the impulse of a link's load over dt to velocity_ (impulse_factor.h).
void Articulation::add_impulse(int link, double dt) {
  const dse3& load = loads_[static_cast<std::size_t>(link)];
  if (load == dse3{}) return;
  const auto add = [&] {
    std::uint32_t d = factor_.first(link);
    for (std::uint32_t k = 0; k < factor_.depth(link); ++k, d = factor_.next()[d]) {
      velocity_[d] += rate_[k];
    }
  };
  factor_.force_row(link, T_world_link(link).position(), dt * load.f, rate_.data());
  add();
  factor_.moment_row(link, dt * load.m, rate_.data());
  add();
}
void Articulation::add_joint_impulse(std::uint32_t dof, double dt) {
  const detail::ImpulseFactor::JointRow row = factor_.joint_row(dof);
  std::uint32_t d = dof;
  for (std::uint32_t k = 0; k < factor_.depth_of_dof(dof); ++k, d = factor_.next()[d]) {
    velocity_[d] += dt * joint_loads_[dof] * row.y[k];
  }
}

bool Articulation::integrate_forces(double dt, bool& changed) {
  if (sub_stepped) {
    implicit_.clear();
  } else if (!constant_ && !implicit_is_chosen_) {
    implicit_.choose(dt, dofs, q);
  }
  implicit_is_chosen_ = false;
  for (std::size_t i = 0; i < v.size(); ++i) forced_[i] -= v[i];
  const bool fine = add_forces(dt, changed);
  for (std::size_t i = 0; i < v.size(); ++i) forced_[i] += v[i];
  if (sub_stepped) reactions_.act(dt);  // otherwise at the start
  if (damped_) add_damping_efforts(v);
  return fine;
}

// Efforts of the damping in the factor, for the velocities `gained`.
void Articulation::add_damping_efforts(std::span<const double> gained) {
  for (std::size_t i = 0; i < v.size(); ++i) {
    reactions_.add_effort(i, -factored_time_ * damping_[i] * gained[i]);
  }
}

void Articulation::take_back_forces(double fraction) {
  for (std::size_t i = 0; i < v.size(); ++i) {
    const double added = fraction * forced_[i];
    if (added * v[i] > 0.0)
      v[i] -= std::copysign(std::min(std::fabs(added), std::fabs(v[i])), v[i]);
  }
  refresh();
}

// M + dt D + G, G being the gains of motors and springs. A motor or spring that hardly lets its
// joint move stays a row: the difference c - G v would lose digits.
bool Articulation::factor_for_step(double dt) {
  constexpr double kMaxGain = 1e6;  // times the inertia that the joint moves
  const double damping_time = damped_ ? dt : 0.0;
  bool fine = factor_.factor(model_, data_, damping_time, inertias_, implicit_.gains());
  inertias_ = true;
  factored_ = Factored::for_the_step;
  factored_time_ = dt;
  bool stiff = false;
  const std::span<const double> gains = implicit_.gains();
  for (std::size_t i = 0; i < gains.size(); ++i) {
    if (gains[i] <= kMaxGain / (1.0 + kMaxGain) * factor_.moved_inertia(i)) continue;
    implicit_.make_row(i);
    stiff = true;
  }
  if (stiff) fine = factor_.factor(model_, data_, damping_time, inertias_, gains);
  return fine;
}

bool Articulation::find_saturated_motors(bool solved, bool all_become_rows) {
  if (!implicit_.any()) return false;
  if (solved) {
    factor_.to_velocities(velocity_);
    changes_are_found_ = true;
  }
  bool found = false;
  for (std::size_t i = 0; i < v.size(); ++i) {
    if (!implicit_.has_motor(i)) continue;
    const Motor& motor = implicit_.motor(i);
    const double impulse = motor.constant - motor.gain * (v[i] + (solved ? velocity_[i] : 0.0));
    if (std::fabs(impulse) <= motor.limit) continue;
    dofs[i].impulses[kMotorRow] =
        vp::in_range(impulse) ? std::clamp(impulse, -motor.limit, motor.limit) : 0.0;
    implicit_.make_row(i);
    found = true;
  }
  if (found && all_become_rows) {
    for (std::size_t i = 0; i < v.size(); ++i) {
      if (implicit_.has_motor(i)) implicit_.make_row(i);
    }
  }
  return found;
}

void Articulation::restart_forces() {
  if (damped_) {
    for (std::size_t i = 0; i < v.size(); ++i) {
      reactions_.add_effort(i, factored_time_ * damping_[i] * v[i]);
    }
  }
  implicit_is_chosen_ = true;
  v = start_v_;
  twists_ = false;
  std::fill(forced_.begin(), forced_.end(), 0.0);
}

void Articulation::store_implicit_impulses() {
  if (!implicit_.any()) return;
  const auto impulse_of = [](const Motor& f, double speed) {
    const double impulse = f.constant - f.gain * speed;
    return vp::in_range(impulse) ? impulse : 0.0;
  };
  for (std::size_t i = 0; i < v.size(); ++i) {
    if (implicit_.has_motor(i)) dofs[i].impulses[kMotorRow] = impulse_of(implicit_.motor(i), v[i]);
    if (implicit_.has_spring(i)) {
      dofs[i].impulses[kSpringRow] = impulse_of(implicit_.spring(i), v[i]);
    }
  }
}

bool Articulation::add_forces(double dt, bool& changed) {
  changed = true;
  if (constant_) {
    changed = add_constant_forces(dt);
    return true;
  }
  const bool fine = factor_for_step(dt);
  if (!has_user_joints_ || !floating_.empty()) factor_.twists(v);
  for (std::size_t i = 0; i < floating_.size(); ++i) {
    composites_[i] = floating_[i].composite_of_twists(data_, factor_);
  }
  if (loaded_) find_force_response();
  find_change(dt, v);
  sub_stepped ? find_midpoint_change(dt) : find_change_at_middle(dt);
  for (std::size_t i = 0; i < v.size(); ++i) v[i] += change_[i];
  if (!floating_.empty()) factor_.twists(v);
  for (std::size_t i = 0; i < floating_.size(); ++i) {
    composites_[i].linear += (dt * composites_[i].mass) * gravity_;
  }
  if (loaded_) add_loads_of_trees(dt);
  for (std::size_t i = 0; i < floating_.size(); ++i) {
    const CompositeBody now = floating_[i].composite_of_twists(data_, factor_);
    floating_[i].set_momentum(model_, data_, now, composites_[i], v);
  }
  update_twists();
  return fine;
}

}  // namespace vp
