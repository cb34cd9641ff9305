// With v* = v + h a_free, G = J M^-1 J^T over the constraints (e) and the joints with a force law
// (j):
//
//   constraints  J v+ = -h b, from J a + b = 0:  G_ee p_e + G_ej p_j = -h b - J v*
//   eliminated   G' = G_jj - G_je G_ee^+ G_ej,  w' = v*_j + G_je G_ee^+ (-h b - J v*)
//   force laws   w = w' + G' p_j, each on its force law (force_law_solver.h)
//   then         v+ = v* + Y^T p
//
// The force laws, with x = q - lower and so on:
//   spring and damper  slope h (h k + d),  zero at  k (rest - q) / (h k + d)
//   motor              the same towards its targets, clamped at h max_force
//   friction           a step at 0, between -h f and h f
//   stop               a step at (lower - q) / h, from 0 up;  a soft limit is a slope from there
#include "vphysics/multibody/constrained_step.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "multibody/constraint_work.h"
#include "vphysics/assert.h"
#include "vphysics/multibody/configuration.h"

namespace vp {
namespace detail {

namespace {

// A coordinate that starts beyond its stop moves back by this fraction in each step, as a position
// correction without velocity: it must neither jump nor gain speed.
constexpr double kStopCorrection = 0.2;
// Force laws with a larger residual contradict each other.
constexpr double kMaxResidual = 1e-3;

tl::unexpected<Error> bad_step(const char* why) {
  return tl::make_unexpected(
      Error{Errc::invalid_argument, std::string("constrained_step: ") + why});
}

bool is_motor(const Motor& m) {
  return m.stiffness != 0.0 || m.damping != 0.0;
}
bool is_fine(const Motor& m) {
  return std::isfinite(m.position) && std::isfinite(m.velocity) && m.stiffness >= 0.0 &&
         m.stiffness < 1e300 && m.damping >= 0.0 && m.damping < 1e300 && m.max_force >= 0.0;
}

// k (target - q) + d (v_target - v), at the end of the step.
Ramp pull(double k, double d, double away, double target_rate, double h) {
  const double slope = h * k + d;
  return {h * slope, slope > 0.0 ? (k * away + d * target_rate) / slope : 0.0};
}

Ramp motor_ramp(const Motor& m, const JointForces& f, double q, double h) {
  Ramp ramp = pull(m.stiffness, m.damping, m.position - q, m.velocity, h);
  ramp.highest = h * std::min(m.max_force, f.motor_limit);
  ramp.lowest = -ramp.highest;
  return ramp;
}

// A limit at distance `away` [m, rad]. The lower limit acts in the positive direction.
Ramp limit_ramp(const JointForces& f, double away, bool lower, double h) {
  Ramp ramp{kUnbounded, away / h};
  const bool beyond = lower ? away > 0.0 : away < 0.0;
  if (f.limit_stiffness == kUnbounded) {
    if (beyond) ramp.w0 = 0.0;
  } else {
    const double slope = h * f.limit_stiffness + f.limit_damping;
    ramp.slope = h * slope;
    // Damping starts where the coordinate passes the limit.
    if (beyond) ramp.w0 = f.limit_stiffness * away / slope;
  }
  (lower ? ramp.lowest : ramp.highest) = 0.0;
  return ramp;
}

// The force law of one velocity. The motor's ramp, if any, comes first.
struct ForceLawOf {
  const JointForces* forces;
  double damping;
  const Motor* motor;
  bool by_coordinate;

  bool any() const {
    return damping > 0.0 || motor != nullptr ||
           (forces != nullptr && (forces->stiffness > 0.0 || forces->friction > 0.0 ||
                                  forces->lower > -kUnbounded || forces->upper < kUnbounded));
  }
  void make(ForceLaw& force_law, double q, double h) const {
    static const JointForces kNone;
    const JointForces& f = forces != nullptr ? *forces : kNone;
    force_law.clear();
    if (motor != nullptr) {
      Motor m = *motor;
      if (!by_coordinate) m.stiffness = 0.0;
      force_law.add(motor_ramp(m, f, q, h));
    }
    if (f.stiffness > 0.0 || damping > 0.0)
      force_law.add(pull(f.stiffness, damping, f.rest - q, 0.0, h));
    if (f.friction > 0.0) force_law.add({kUnbounded, 0.0, -h * f.friction, h * f.friction});
    if (f.lower > -kUnbounded) force_law.add(limit_ramp(f, f.lower - q, true, h));
    if (f.upper < kUnbounded) force_law.add(limit_ramp(f, f.upper - q, false, h));
  }
};

// Collects the velocities that have a force law, and makes the laws at q.
void make_force_laws(const Model& model, ConstraintWork& work, std::span<const double> q,
                     std::span<const Motor> motors, double h) {
  work.joints.clear();
  for (int l = 0; l < model.links(); ++l) {
    const LinkSpec& link = model.link(l);
    const auto first = static_cast<std::size_t>(model.first_velocity(l));
    const auto dofs = static_cast<std::size_t>(velocities_of(link.joint));
    for (std::size_t k = 0; k < dofs; ++k) {
      const std::size_t i = first + k;
      const int c = work.coordinate[i];
      const ForceLawOf force_law{link.forces.empty() ? nullptr : &link.forces[k], link.damping,
                                 motors.empty() || !is_motor(motors[i]) ? nullptr : &motors[i],
                                 c >= 0};
      if (!force_law.any()) continue;
      force_law.make(work.force_laws.force_laws[work.joints.size()],
                     c < 0 ? 0.0 : q[static_cast<std::size_t>(c)], h);
      work.joints.push_back(i);
    }
  }
}

// Writes v* to v. Viscous damping is part of the joints' force laws, so its explicit force is
// removed here.
Expected<void> free_velocities(const Model& model, ConstraintWork& work, std::span<const double> q,
                               std::span<double> v, std::span<const double> tau, const Loads& loads,
                               double h) {
  std::copy(tau.begin(), tau.end(), work.tau.begin());
  for (int l = 0; l < model.links(); ++l) {
    const int first = model.first_velocity(l);
    for (int i = first; i < first + velocities_of(model.link(l).joint); ++i) {
      const auto k = static_cast<std::size_t>(i);
      work.tau[k] += model.link(l).damping * v[k];
    }
  }
  if (auto fine = forward_dynamics<double>(model, work.data, q, v, work.tau, loads, work.step);
      !fine) {
    return fine;
  }
  evaluate_rows(model, work, q, v);
  for (std::size_t i = 0; i < v.size(); ++i) v[i] += h * work.step[i];
  return {};
}

// Sets up the system of the force laws, with the constraints eliminated.
void eliminate_constraints(ConstraintWork& work, std::span<const double> v) {
  ForceLawSolver& force_laws = work.force_laws;
  const std::size_t e = work.rows, n = work.joints.size(), stride = work.capacity();
  force_laws.size = n;
  work.cholesky.factor(work.G, e, stride, work.floor);
  std::copy_n(work.rhs.begin(), e, work.lambda.begin());
  work.cholesky.solve(std::span(work.lambda).first(e));
  for (std::size_t j = 0; j < n; ++j) {
    force_laws.w_free[j] = v[work.joints[j]];
    force_laws.self[j] = work.G[(e + j) * stride + e + j];
    for (std::size_t k = 0; k < e; ++k) {
      work.left[k] = work.G[k * stride + e + j];
      force_laws.w_free[j] += work.left[k] * work.lambda[k];
    }
    work.cholesky.solve(std::span(work.left).first(e));
    for (std::size_t i = 0; i < n; ++i) {
      double sum = work.G[(e + i) * stride + e + j];
      for (std::size_t k = 0; k < e; ++k) sum -= work.G[(e + i) * stride + k] * work.left[k];
      force_laws.G[i * force_laws.capacity + j] = sum;
    }
  }
  // Makes G symmetric to the bit; the sums above are symmetric only to rounding.
  for (std::size_t i = 0; i < n; ++i) {
    for (std::size_t j = 0; j < i; ++j)
      force_laws.G[j * force_laws.capacity + i] = force_laws.G[i * force_laws.capacity + j];
  }
  for (std::size_t j = 0; j < n; ++j) force_laws.p[j] = work.warm[work.joints[j]];
}

// Computes the constraint impulses from those of the force laws. lambda contains both: constraints
// first. left contains the residual of dependent rows.
void find_impulses(ConstraintWork& work) {
  const std::size_t e = work.rows, n = work.joints.size(), stride = work.capacity();
  for (std::size_t i = 0; i < e; ++i) {
    double sum = work.rhs[i];
    for (std::size_t j = 0; j < n; ++j) sum -= work.G[i * stride + e + j] * work.force_laws.p[j];
    work.lambda[i] = work.left[i] = sum;
  }
  work.cholesky.solve(std::span(work.lambda).first(e));
  for (std::size_t i = 0; i < e; ++i) {
    for (std::size_t j = 0; j < e; ++j) work.left[i] -= work.G[i * stride + j] * work.lambda[j];
  }
  for (std::size_t j = 0; j < n; ++j) work.lambda[e + j] = work.force_laws.p[j];
}

// Solves for all impulses. If J v+ = -h b has no solution, J v+ = 0 may have one (called with h =
// 0): where joints lock or reach their stops while the loops move, the velocities from which b was
// computed no longer exist.
bool solve_step(ConstraintWork& work, std::span<const double> v, double h, StepReport& report) {
  for (std::size_t i = 0; i < work.rows; ++i) {
    const double speed = work.along(i, v), bias = h * work.bias[i];
    work.rhs[i] = -bias - speed;
    work.terms[i] = std::fabs(bias) + std::fabs(speed);
  }
  eliminate_constraints(work, v);
  report.iterations += work.force_laws.solve();
  report.converged = work.force_laws.off() < 1e-9;
  find_impulses(work);
  return work.force_laws.off() < kMaxResidual && !contradicted(work);
}

// Stores impulses as forces, and for the warm start of the next step.
void store_forces(ConstraintWork& work, std::span<const Motor> motors, double h) {
  std::fill(work.force_law_force.begin(), work.force_law_force.end(), 0.0);
  std::fill(work.motor_force.begin(), work.motor_force.end(), 0.0);
  std::fill(work.warm.begin(), work.warm.end(), 0.0);
  const ForceLawSolver& force_laws = work.force_laws;
  for (std::size_t j = 0; j < work.joints.size(); ++j) {
    const std::size_t i = work.joints[j];
    work.warm[i] = force_laws.p[j];
    work.force_law_force[i] = force_laws.p[j] / h;
    if (motors.empty() || !is_motor(motors[i])) continue;
    work.motor_force[i] =
        force_laws.force_laws[j].part_of_first(force_laws.on[j].w, force_laws.p[j]) / h;
  }
}

// Writes v+ to v. A joint at a step of its force law gets exactly the law's velocity, so that a
// sticking joint does not creep.
void apply_impulses(ConstraintWork& work, std::span<double> v) {
  add_response(work, work.lambda, v);
  for (std::size_t j = 0; j < work.joints.size(); ++j) {
    if (work.force_laws.on[j].at_step) v[work.joints[j]] = work.force_laws.on[j].w;
  }
}

// Writes q+ to q. Moves coordinates beyond a stop back towards it.
void move(const Model& model, ConstraintWork& work, std::span<double> q, std::span<const double> v,
          double h) {
  for (std::size_t i = 0; i < v.size(); ++i) work.step[i] = h * v[i];
  integrate<double>(model, q, work.step, q);
  for (int l = 0; l < model.links(); ++l) {
    const std::vector<JointForces>& forces = model.link(l).forces;
    for (std::size_t k = 0; k < forces.size(); ++k) {
      const int c = work.coordinate[static_cast<std::size_t>(model.first_velocity(l)) + k];
      if (c < 0 || forces[k].limit_stiffness < kUnbounded) continue;
      double& x = q[static_cast<std::size_t>(c)];
      if (x < forces[k].lower) x += kStopCorrection * (forces[k].lower - x);
      if (x > forces[k].upper) x += kStopCorrection * (forces[k].upper - x);
    }
  }
}

// Projects q and v onto the constraints, from an error of O(h^2). Joints at a step of their force
// law keep their coordinates if the loops can be closed with them.
Expected<void> return_to_constraints(const Model& model, ConstraintWork& work, std::span<double> q,
                                     std::span<double> v) {
  constexpr double kTolerance = 1e-12;
  constexpr int kMaxSteps = 20;
  std::copy(q.begin(), q.end(), work.q_before.begin());
  std::size_t count = 0;
  for (std::size_t j = 0; j < work.joints.size(); ++j) {
    if (work.force_laws.on[j].at_step) work.joints[count++] = work.joints[j];
  }
  work.joints.resize(count);
  auto closed = close(model, work, q, kTolerance, kMaxSteps);
  if (!closed && count > 0) {
    work.joints.clear();
    std::copy(work.q_before.begin(), work.q_before.end(), q.begin());
    closed = close(model, work, q, kTolerance, kMaxSteps);
  }
  if (!closed) return tl::make_unexpected(closed.error());
  if (auto fine = factor_mass<double>(model, work.data, q); !fine) return fine;
  respond(model, work);
  for (std::size_t i = 0; i < work.in_use(); ++i) {
    work.rhs[i] = i < work.rows ? -work.along(i, v) : 0.0;
  }
  solve_rows(work, work.lambda);
  std::fill(work.step.begin(), work.step.end(), 0.0);
  add_response(work, work.lambda, work.step);
  for (const std::size_t i : work.joints) work.step[i] = 0.0;
  for (std::size_t i = 0; i < v.size(); ++i) v[i] += work.step[i];
  return {};
}

}  // namespace
}  // namespace detail

Expected<StepReport> constrained_step(const Model& model, ConstrainedData& data,
                                      std::span<double> q, std::span<double> v,
                                      std::span<const double> tau, std::span<const Motor> motors,
                                      const Loads& loads, double h) {
  detail::ConstraintWork& work = data.work();
  VP_ASSERT(q.size() == work.q_trial.size() && v.size() == work.velocities);
  VP_ASSERT(tau.size() == v.size() && (motors.empty() || motors.size() == v.size()));
  if (!(h > 0.0 && h < 1e6)) return detail::bad_step("the step must be positive, and in seconds");
  for (const Motor& m : motors) {
    if (!detail::is_fine(m)) {
      return detail::bad_step("motors must have finite targets and no negative numbers");
    }
  }
  detail::make_force_laws(model, work, q, motors, h);
  if (auto fine = detail::free_velocities(model, work, q, v, tau, loads, h); !fine) {
    return tl::make_unexpected(fine.error());
  }
  detail::respond(model, work);
  StepReport report;
  if (!detail::solve_step(work, v, h, report) && !detail::solve_step(work, v, 0.0, report)) {
    return detail::contradiction("constrained_step");
  }
  detail::store_forces(work, motors, h);
  detail::apply_impulses(work, v);
  detail::move(model, work, q, v, h);
  if (work.rows > 0) {
    if (auto fine = detail::return_to_constraints(model, work, q, v); !fine) {
      return tl::make_unexpected(fine.error());
    }
  }
  return report;
}

std::span<const double> force_law_forces(const ConstrainedData& data) {
  return data.work().force_law_force;
}
std::span<const double> motor_forces(const ConstrainedData& data) {
  return data.work().motor_force;
}

}  // namespace vp
