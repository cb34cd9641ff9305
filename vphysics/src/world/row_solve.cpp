#include "world/row_solve.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "solve/state_vector.h"
#include "world/joint_steps.h"

namespace vp {
namespace {

// Number of simultaneous contacts whose rows have memory reserved in advance.
constexpr std::size_t kContactsReady = 32;

// The rows of one degree of freedom. f = k (p - q - h v) + d (v_t - v), of a motor or a spring, is
// a soft row: v + s f h = target with s = 1 / (h^2 k + h d), target = (h k (p - q) + h d v_t) s.
class JointRows {
 public:
  // with_memory: rows warm start from their impulses of the last step and store the new ones.
  // fraction: length of these rows' interval, in steps, by which the last impulses are scaled.
  JointRows(std::vector<solve::JointRow>& rows, std::uint32_t articulation, std::uint32_t i,
            Articulation& art, bool with_memory, double fraction)
      : rows_(rows),
        dof_(art.dofs[i]),
        speed_(art.v[i]),
        articulation_(articulation),
        i_(i),
        with_memory_(with_memory) {
    if (dof_.coordinate >= 0) q_ = art.q[static_cast<std::size_t>(dof_.coordinate)];
    if (!with_memory_) return;
    for (std::size_t k = 0; k < before_.size(); ++k) before_[k] = fraction * dof_.impulses[k];
    dof_.impulses = {};
  }

  void add_motor(double h) {
    const Motor motor = motor_of(dof_, h, q_);
    if (motor.limit <= 0.0) return;
    add(kMotorRow, motor.constant / motor.gain, -motor.limit, motor.limit, 1.0 / motor.gain);
  }
  // Spring, unless it is in the factor, dry friction, and compliant limits.
  void add_passive(double h, bool with_spring) {
    const JointForces& f = dof_.forces;
    if (f.friction > 0.0 && !dof_.locked) {
      add(kFrictionRow, 0.0, -h * f.friction, h * f.friction);
    }
    if (dof_.coordinate < 0) return;
    if (f.stiffness > 0.0 && with_spring)
      add_spring(kSpringRow, h, f.stiffness, 0.0, f.rest, -kAny, kAny);
    if (std::isfinite(f.limit_stiffness)) {
      if (std::isfinite(f.lower)) {
        add_spring(kLowerRow, h, f.limit_stiffness, f.limit_damping, f.lower, 0.0, kAny);
      }
      if (std::isfinite(f.upper)) {
        add_spring(kUpperRow, h, f.limit_stiffness, f.limit_damping, f.upper, -kAny, 0.0);
      }
    }
  }
  // A stop lets the joint just reach it within h, and corrects a violation within dt. A locked
  // joint has zero velocity.
  void add_stops(double h, double dt) {
    if (dof_.locked) add(kFrictionRow, 0.0, -kAny, kAny);
    if (dof_.coordinate < 0) return;
    const double below = dof_.lower - q_, above = dof_.upper - q_;
    const double range = stop_range(h, speed_);
    if (below > -range) add(kLowerRow, below / (below > 0.0 ? dt : h), 0.0, kAny);
    if (above < range) add(kUpperRow, above / (above < 0.0 ? dt : h), -kAny, 0.0);
  }

 private:
  static constexpr double kAny = 1e30;

  void add(RowOfDof kind, double target, double lower, double upper, double softness = 0.0) {
    solve::JointRow& row = rows_.emplace_back();
    row.articulation = articulation_;
    row.dof = i_;
    row.speed = speed_;
    row.target = target;
    row.softness = softness;
    row.lower = lower;
    row.upper = upper;
    row.impulse = row.warm_start = std::clamp(before_[kind], lower, upper);
    row.remember = with_memory_ ? &dof_.impulses[kind] : nullptr;
  }
  void add_spring(RowOfDof kind, double h, double stiffness, double damping, double rest,
                  double lower, double upper) {
    const double gain = h * (h * stiffness + damping);
    if (gain > 0.0) add(kind, h * stiffness * (rest - q_) / gain, lower, upper, 1.0 / gain);
  }

  std::vector<solve::JointRow>& rows_;
  JointDof& dof_;
  double speed_, q_ = 0.0;
  std::uint32_t articulation_, i_;
  bool with_memory_;
  std::array<double, kRowsOfDof> before_{};
};

}  // namespace

void RowSolve::reserve() {
  std::size_t deepest = 0, dofs = 0;
  most_dofs_ = 0;
  for (const Articulation& art : s_.articulations) {
    deepest = std::max(deepest, art.deepest());
    dofs += art.dofs.size();
    most_dofs_ = std::max(most_dofs_, art.dofs.size());
  }
  constexpr std::size_t kRowsOfCoordinate = 3;  // of a joint in rows: drive and stops
  const std::size_t in_rows = static_cast<std::size_t>(std::count_if(
      s_.joints.begin(), s_.joints.end(), [](const BodyJoint& j) { return j.alive && j.in_rows; }));
  joints_.reserve(in_rows);
  pairs_.reserve(kRowsOfCoordinate * solve::kJointRows * in_rows);
  rows_.reserve(kRowsOfDof * dofs + kRowsOfCoordinate * solve::kJointRows * in_rows);
  constexpr std::size_t kRows = 3 * collide::kMaxPoints + 3;
  const std::size_t of_joints =
      2 * 2 * kRowsOfCoordinate * std::size_t{solve::kJointRows} * in_rows + 1;
  const std::size_t size = (kContactsReady * 2 * kRows + of_joints) * deepest;
  if (link_rows_.size() < size) link_rows_.resize(size);
  articulations_.resize(s_.articulations.size());
}

void RowSolve::begin_step(std::size_t contacts) {
  instant_.reserve(contacts, rows_.capacity(), most_dofs_);
  bodies_.resize(s_.bodies.size());
  list_joints();
}

void RowSolve::list_joints() {
  joints_.clear();
  for (std::uint32_t i = 0; i < s_.joints.size(); ++i) {
    BodyJoint& joint = s_.joints[i];
    if (!joint.alive || !joint.in_rows) continue;
    joint.force = joint.torque = {};
    joints_.push_back(i);
  }
}

bool RowSolve::is_in_sub_steps(const BodyJoint& joint) const {
  const Body &a = s_.bodies[joint.a], &b = s_.bodies[joint.b];
  return in_sub_steps(s_.articulations, a, b) && !a.continuous && !b.continuous;
}

void RowSolve::add_rows(const RowJointStep& step) {
  add_rows_of_articulations(step);
  add_rows_of_joints(step);
}

// Motors, springs and friction act once a step, or once a sub-step. Impacts are too short for them
// to act.
void RowSolve::add_rows_of_articulations(const RowJointStep& step) {
  const auto of = step.of;
  const double h = step.left;
  rows_.clear();
  pairs_.clear();
  for (std::uint32_t a = 0; a < s_.articulations.size(); ++a) {
    Articulation& art = s_.articulations[a];
    if (!art.alive || (of == RowsOf::sub_step && !art.sub_stepped)) continue;
    if (of == RowsOf::first_instant && !art.sub_stepped && !art.touched && art.solve_decoupled(h)) {
      if (!art.remote) follow_velocities(art, s_.bodies);
      continue;
    }
    if (art.remote) {
      if (of != RowsOf::first_instant) continue;  // its stops remain satisfied
      follow(art, s_.bodies, s_.lists);
    }
    const bool first = of == RowsOf::sub_step || (of == RowsOf::first_instant && !art.sub_stepped);
    for (std::uint32_t i = 0; i < art.dofs.size(); ++i) {
      JointRows rows(rows_, a, i, art, first, step.fraction);
      if (first) {
        if (!art.implicit().has_motor(i)) rows.add_motor(h);
        if (art.dofs[i].passive) rows.add_passive(h, !art.implicit().has_spring(i));
      }
      rows.add_stops(h, step.h);
    }
  }
}

solve::SolverBody& RowSolve::load_body(std::uint32_t index, const Vec3& at,
                                       const Velocity& forced) {
  const Body& body = s_.bodies[index];
  solve::SolverBody& s = bodies_[index];
  s = {};
  s.articulation = -1;
  s.w = body.w;
  s.v = body.v;
  s.x = at;
  s.forced_w = forced.w;
  s.forced_v = forced.v;
  if (body.motion != Motion::dynamic) return s;
  if (body.is_link) {
    s.articulation = static_cast<int>(body.articulation);
    s.link = body.link;
  } else {
    s.inverse_mass = body.inverse_mass;
    s.angular =
        body.isotropic ? body.inverse_central : rotated(body.T.rotation(), body.inverse_central);
  }
  return s;
}

// Records the impulses of contacts on links in a solve, at the contact points of the solver.
void RowSolve::note_link_impulses(std::span<const solve::ContactConstraint> solved) {
  for (const solve::ContactConstraint& c : solved) {
    const Body &a = s_.bodies[c.a], &b = s_.bodies[c.b];
    if (!a.is_link && !b.is_link) continue;
    const Vec3 at = bodies_[c.b].x;
    Vec3 impulse{}, moment = c.rolling_mass > 0.0 ? c.rolling_impulse : Vec3{};  // on b
    for (int i = 0; i < c.count; ++i) {
      const solve::ContactPoint& p = c.points[i];
      const Vec3 of_point = p.normal_impulse * c.normal + p.tangent_impulse[0] * c.tangent[0] +
                            p.tangent_impulse[1] * c.tangent[1];
      impulse += of_point;
      moment += cross(p.arm_b, of_point);
    }
    moment += cross(at, impulse);
    if (b.is_link) s_.articulations[b.articulation].add_external_impulse(b.link, impulse, moment);
    if (a.is_link) s_.articulations[a.articulation].add_external_impulse(a.link, -impulse, -moment);
  }
}

solve::StepContext RowSolve::context(std::span<solve::ContactConstraint> contacts, double duration,
                                     double step) {
  return {bodies_,
          contacts,
          rows_,
          pairs_,
          articulations_,
          link_rows_,
          instant_,
          duration,
          step,
          s_.desc.contact_slop,
          s_.desc.restitution_threshold,
          s_.desc.velocity_iterations};
}

// The poses after h, at the current velocities, of links with joints in rows.
void RowSolve::find_next_poses(double h) {
  if (joints_.empty()) return;
  next_poses_.resize(s_.bodies.size());
  for (const std::uint32_t i : joints_) {
    for (const std::uint32_t b : {s_.joints[i].a, s_.joints[i].b}) {
      if (s_.bodies[b].is_link) s_.articulations[s_.bodies[b].articulation].needs_next_pose = true;
    }
  }
  for (Articulation& art : s_.articulations) {
    if (!std::exchange(art.needs_next_pose, false) || art.sub_stepped) continue;
    art.for_poses_after(h, [&](int link, const SE3& T) {
      next_poses_[art.bodies[static_cast<std::size_t>(link)]] = T;
    });
  }
}

RowEnd RowSolve::row_end(std::uint32_t index, const RowJointStep& step) const {
  const Body& body = s_.bodies[index];
  if (step.of == RowsOf::sub_step && joins_sub_steps(body)) {
    const solve::BodyState& state = s_.body_states[index + 1];
    const BodyPose now = pose_within_step(body, state, s_.start_displacements[index]);
    return {now, {vector_of(state.velocity + 3), vector_of(state.velocity)}, now};
  }
  RowEnd end{pose_of(body), {body.w, body.v}, pose_of(body)};
  if (step.of != RowsOf::first_instant || body.motion == Motion::fixed) return end;
  if (body.is_link) {
    end.next.T = next_poses_[index];
    end.next.centre = end.next.T.position();
  } else {
    const Mat3 R = rotated(body.T.rotation(), step.h * body.w);
    const Vec3 arm = transposed_times(body.T.rotation(), end.now.centre - body.T.position());
    end.next.centre += step.h * body.v;
    end.next.T = SE3(R, end.next.centre - R * arm);
  }
  return end;
}

void RowSolve::add_rows_of_joints(const RowJointStep& step) {
  const bool of_sub_step = step.of == RowsOf::sub_step;
  if (step.of == RowsOf::first_instant) find_next_poses(step.h);
  for (const std::uint32_t i : joints_) {
    BodyJoint& joint = s_.joints[i];
    if (is_in_sub_steps(joint) != of_sub_step) continue;
    vp::add_rows(joint, i, row_end(joint.a, step), row_end(joint.b, step), step, rows_, pairs_);
  }
}

void RowSolve::take_back_joints(const RowJointStep& step) {
  vp::take_back(rows_, pairs_, step, s_.dt, s_.joints);
  for (const solve::JointRow& row : rows_) {
    if (row.pair == solve::kNoPair) continue;
    const solve::JointPair& pair = pairs_[row.pair];
    for (const solve::PairEnd* end : {&pair.a, &pair.b}) {
      const Body& body = s_.bodies[end->body];
      if (!body.is_link) continue;
      const Vec3 impulse = row.impulse * end->linear;
      const Vec3 moment = row.impulse * end->angular + cross(bodies_[end->body].x, impulse);
      s_.articulations[body.articulation].add_external_impulse(body.link, impulse, moment);
    }
  }
}

// Checks the joints in rows at the end of a step.
void RowSolve::note_open_joints() {
  for (const std::uint32_t i : joints_) {
    const BodyJoint& joint = s_.joints[i];
    double size = 0.0;
    for (const auto& [index, T] :
         {std::pair{joint.a, &joint.T_a_joint}, std::pair{joint.b, &joint.T_b_joint}}) {
      const Body& body = s_.bodies[index];
      if (body.motion != Motion::dynamic) continue;
      const Vec3 centre =
          body.is_link ? s_.articulations[body.articulation].centre_of(body.link) : body.centre;
      const double own = std::max(body.bounding_radius, norm(T->position() - centre));
      if (own > 0.0) size = size > 0.0 ? std::min(size, own) : own;
    }
    if (size > 0.0 &&
        is_far_open(joint, pose_of(s_.bodies[joint.a]), pose_of(s_.bodies[joint.b]), size)) {
      s_.position_error = true;
    }
  }
}

}  // namespace vp
