// Articulations within a world: updates their links' bodies from their coordinates, and adds their
// motors and stops as rows of the solver.
#include <algorithm>
#include <cmath>

#include "world/impl.h"
#include "world/validate.h"

namespace vp {

// Number of simultaneous contacts whose rows have memory reserved in advance.
constexpr std::size_t kContactsReady = 32;

void follow(Articulation& art, Bodies& bodies, BodyLists& lists) {
  if (art.remote) {
    art.remote = false;
    art.refresh();
    for (const std::uint32_t b : art.bodies) bodies[b].remote = false;
    lists.invalidate_impacts();
  }
  follow_poses(art, bodies);
  follow_velocities(art, bodies);
}
void follow_poses(const Articulation& art, Bodies& bodies) {
  for (const std::uint32_t b : art.bodies) {
    Body& body = bodies[b];
    if (!body.is_followed()) continue;
    body.T = art.T_world_link(body.link);
    body.moved();
  }
}
void follow_velocities(const Articulation& art, Bodies& bodies) {
  follow_velocities(art, bodies, [](std::uint32_t, const se3&) {});
}

bool stop_if_out_of_range(const StepContext& s, Articulation& art) {
  if (art.in_range()) return false;
  s.status.non_finite = true;
  art.return_to_start();
  follow(art, s.bodies, s.lists);
  return true;
}

bool in_sub_steps(const std::vector<Articulation>& articulations, const Body& a, const Body& b) {
  return (a.is_link && articulations[a.articulation].sub_stepped) ||
         (b.is_link && articulations[b.articulation].sub_stepped);
}

void World::Impl::reserve_link_rows() {
  std::size_t deepest = 0, dofs = 0;
  for (const Articulation& art : articulations) {
    deepest = std::max(deepest, art.deepest());
    dofs += art.dofs.size();
  }
  constexpr std::size_t kRowsOfCoordinate = 3;  // of a joint in rows: drive and stops
  const std::size_t in_rows = static_cast<std::size_t>(std::count_if(
      joints.begin(), joints.end(), [](const BodyJoint& j) { return j.alive && j.in_rows; }));
  impacts.row_joints.reserve(in_rows);
  impacts.joint_pairs.reserve(kRowsOfCoordinate * solve::kJointRows * in_rows);
  impacts.joint_rows.reserve(kRowsOfDof * dofs + kRowsOfCoordinate * solve::kJointRows * in_rows);
  constexpr std::size_t kRows = 3 * collide::kMaxPoints + 3;
  const std::size_t of_joints =
      2 * 2 * kRowsOfCoordinate * std::size_t{solve::kJointRows} * in_rows + 1;
  const std::size_t size = (kContactsReady * 2 * kRows + of_joints) * deepest;
  if (impacts.link_rows.size() < size) impacts.link_rows.resize(size);
  impacts.solver_articulations.resize(articulations.size());
}

void World::Impl::integrate_articulations(double dt) {
  for (Articulation& art : articulations) {
    if (!art.alive || art.sub_stepped) continue;  // integrated in the sub-steps
    art.mark_start();
    if (art.remote) continue;  // balanced: only its motors exert forces
    integrate_forces_of(art, dt);
  }
}

void World::Impl::integrate_forces_of(Articulation& art, double dt) {
  bool changed = false;
  if (!art.integrate_forces(dt, changed)) {
    status.non_finite = true;
    art.return_to_start();
  }
  if (changed) follow_velocities(art, bodies);
}

namespace {

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

// Motors, springs and friction act once a step, or once a sub-step. Impacts are too short for them
// to act.
void World::Impl::add_joint_rows(double h, double dt, RowsOf of) {
  const double fraction = h / dt_now;
  impacts.joint_rows.clear();
  impacts.joint_pairs.clear();
  for (std::uint32_t a = 0; a < articulations.size(); ++a) {
    Articulation& art = articulations[a];
    if (!art.alive || (of == RowsOf::sub_step && !art.sub_stepped)) continue;
    if (of == RowsOf::first_instant && !art.sub_stepped && !art.touched && art.solve_decoupled(h)) {
      if (!art.remote) follow_velocities(art, bodies);
      continue;
    }
    if (art.remote) {
      if (of != RowsOf::first_instant) continue;  // its stops remain satisfied
      follow(art);
    }
    const bool first = of == RowsOf::sub_step || (of == RowsOf::first_instant && !art.sub_stepped);
    for (std::uint32_t i = 0; i < art.dofs.size(); ++i) {
      JointRows rows(impacts.joint_rows, a, i, art, first, fraction);
      if (first) {
        if (!art.implicit().has_motor(i)) rows.add_motor(h);
        if (art.dofs[i].passive) rows.add_passive(h, !art.implicit().has_spring(i));
      }
      rows.add_stops(h, dt);
    }
  }
}

// Whether a motor exceeds its limit that was predicted to stay below it: it is a row now, the
// forces of its articulation are integrated again, and the instant must be solved again.
bool World::Impl::integrate_saturated_again(double dt, bool solved, bool all_become_rows) {
  bool again = false;
  for (Articulation& art : articulations) {
    if (!art.alive || art.remote || art.sub_stepped ||
        !art.find_saturated_motors(solved, all_become_rows))
      continue;
    again = true;
    art.restart_forces();
    follow_velocities(art, bodies);
    const auto note = [&](const auto& forced) {
      for (const std::uint32_t b : art.bodies) {
        if (bodies[b].first_collider != kNone)
          impacts.forced[b] = forced(bodies[b], impacts.forced[b]);
      }
    };
    note([](const Body& body, const Velocity&) { return Velocity{body.w, body.v}; });
    integrate_forces_of(art, dt);
    note([](const Body& body, const Velocity& before) {
      return Velocity{body.w - before.w, body.v - before.v};
    });
  }
  if (again) restore_warm_starts();
  return again;
}

void World::Impl::begin_solve_articulations(bool first) {
  for (std::size_t a = 0; a < articulations.size(); ++a) {
    Articulation& art = articulations[a];
    if (art.alive && !art.remote) impacts.solver_articulations[a] = art.begin_solve(first);
  }
}

void World::Impl::end_solve_articulations(bool first) {
  for (solve::JointRow& row : impacts.joint_rows) {
    if (row.remember) {
      *row.remember = row.impulse;
    } else if (row.pair == solve::kNoPair) {
      articulations[row.articulation].add_effort(row.dof, row.impulse);
    }
  }
  for (Articulation& art : articulations) {
    if (!art.alive || art.remote) continue;
    const Articulation::Change change = art.end_solve();
    if (change == Articulation::Change::none || stop_if_out_of_range(context, art)) continue;
    follow_velocities(art, bodies, [&](std::uint32_t b, const se3& now) {
      if (first && !(impacts.forced[b] == Velocity{}))
        carry(b, now.w - bodies[b].w, now.v - bodies[b].v);
    });
    if (change == Articulation::Change::of_coordinates_too) follow(art);
  }
}

void World::Impl::advance_articulations(double h) {
  for (Articulation& art : articulations) {
    if (!art.alive || impacts.stopped[art.bodies.front()]) continue;
    art.advance(h);
    if (stop_if_out_of_range(context, art)) {
      hold(art.bodies.front());
    } else if (art.remote) {
      // its links wait
    } else if (art.keeps_twists() && !art.sub_stepped) {
      follow_poses(art, bodies);
    } else {
      follow(art);
    }
  }
}

// A link stops together with its whole articulation.
void World::Impl::hold(std::uint32_t index) {
  const auto stand = [&](std::uint32_t b) {
    impacts.stopped[b] = 1;
    impacts.motions[b].v = impacts.motions[b].w = {};
  };
  if (!bodies[index].is_link) return stand(index);
  for (const std::uint32_t b : articulations[bodies[index].articulation].bodies) stand(b);
}

}  // namespace vp
