// With Y = M^-1 J^T and G = J Y, symmetric:
//
//   forward dynamics   a = a_free + Y^T lambda,  G lambda = -(b + 2 r phi' + r^2 phi) - J a_free
//   velocities         v <- v + Y^T p,           G p = -J v
//   positions          q <- q [+] Y^T x,         G x = -phi, iterated until phi = 0
//
// Dependent rows have no lambda of their own. The residual of their equations must vanish, or the
// constraints contradict each other.
#include "vphysics/multibody/constrained_dynamics.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>

#include "multibody/constraint_work.h"
#include "multibody/kinematics.h"
#include "vphysics/assert.h"
#include "vphysics/multibody/configuration.h"

namespace vp {
namespace detail {

// A row below this fraction of the largest term in its sums is zero. Rounding leaves 1e-15; a loop
// closed to 1e-12 leaves as much in rows that should be zero. The measure is the row's own terms,
// so neither its unit nor the mechanism's size matters.
constexpr double kZeroRow = 1e-11;
// The residual allowed in redundant rows, relative to their largest term.
constexpr double kContradiction = 1e-6;

ConstraintWork::ConstraintWork(const Model& model, ConstraintSet constraints)
    : rows(static_cast<std::size_t>(constraints.rows())),
      velocities(static_cast<std::size_t>(model.velocities())),
      set(std::move(constraints)),
      data(model),
      coordinate(velocities, -1),
      phi(rows),
      J(rows * velocities),
      bias(rows),
      magnitude(rows),
      lambda(capacity()),
      link_bias(model.tree().nodes.size()),
      Y(capacity() * velocities),
      G(capacity() * capacity()),
      floor(capacity()),
      cholesky(capacity()),
      rhs(capacity()),
      left(capacity()),
      terms(capacity()),
      step(velocities),
      q_trial(static_cast<std::size_t>(model.coordinates())),
      v_zero(velocities),
      force_laws(velocities),
      warm(velocities),
      tau(velocities),
      q_before(q_trial.size()),
      force_law_force(velocities),
      motor_force(velocities) {
  joints.reserve(velocities);
  for (int l = 0; l < model.links(); ++l) {
    const Joint& joint = model.link(l).joint;
    const int count = velocities_of(joint);
    if (coordinates_of(joint) != count) continue;
    for (int k = 0; k < count; ++k) {
      coordinate[static_cast<std::size_t>(model.first_velocity(l) + k)] =
          model.first_coordinate(l) + k;
    }
  }
}

double ConstraintWork::along(std::size_t i, std::span<const double> x) const {
  if (i >= rows) return x[joints[i - rows]];
  double sum = 0.0;
  for (std::size_t k = 0; k < velocities; ++k) sum += J[i * velocities + k] * x[k];
  return sum;
}

namespace {

// The rate of a user joint's subspace, S' v, in its node's own frame.
se3 subspace_rate(const Node<double>& node, std::span<const double> q, std::span<const double> v) {
  if (node.kind != NodeKind::user) return {};
  const auto dofs = static_cast<std::size_t>(node.dofs);
  SE3 X;
  std::array<se3, 6> S{};
  se3 rate{};
  node.user->evaluate(q.subspan(static_cast<std::size_t>(node.q), dofs),
                      v.subspan(static_cast<std::size_t>(node.v), dofs), X,
                      std::span(S).first(dofs), rate);
  return rate;
}

// V' of each node at zero joint accelerations, in the tree's frame.
void bias_of_links(const Tree<double>& tree, ConstraintWork& work, std::span<const double> q,
                   std::span<const double> v) {
  const Work<double>& links = work.data.work();
  for (std::size_t i = 0; i < tree.nodes.size(); ++i) {
    const int node = static_cast<int>(i), parent = tree.nodes[i].parent;
    se3 V_parent{}, before{};
    if (parent != kWorld) {
      V_parent = velocity_of(links, parent);
      before = work.link_bias[static_cast<std::size_t>(parent)];
    }
    work.link_bias[i] = before + ad(V_parent, velocity_of(links, node)) +
                        Ad(pose_of(links, node), subspace_rate(tree.nodes[i], q, v));
  }
}

double largest_of(std::span<const double> x) {
  double largest = 0.0;
  for (const double value : x) largest = std::max(largest, std::fabs(value));
  return largest;
}

}  // namespace

void evaluate_rows(const Model& model, ConstraintWork& work, std::span<const double> q,
                   std::span<const double> v) {
  bias_of_links(model.tree(), work, q, v);
  std::fill(work.phi.begin(), work.phi.end(), 0.0);
  std::fill(work.bias.begin(), work.bias.end(), 0.0);
  std::fill(work.J.begin(), work.J.end(), 0.0);
  std::fill(work.magnitude.begin(), work.magnitude.end(), 0.0);
  const ConstraintView view(model, work.data, q, v, work.link_bias);
  std::size_t first = 0;
  for (const ConstraintPtr& constraint : work.set.constraints()) {
    const auto count = static_cast<std::size_t>(constraint->rows());
    constraint->evaluate(
        view,
        {std::span(work.phi).subspan(first, count), std::span(work.bias).subspan(first, count),
         std::span(work.J).subspan(first * work.velocities, count * work.velocities),
         std::span(work.magnitude).subspan(first, count), work.velocities});
    first += count;
  }
}

void respond(const Model& model, ConstraintWork& work) {
  const std::size_t n = work.in_use(), capacity = work.capacity();
  for (std::size_t i = 0; i < n; ++i) {
    const std::span<double> y = work.row_of_Y(i);
    if (i < work.rows) {
      std::copy_n(work.row_of_J(i).begin(), work.velocities, y.begin());
    } else {
      std::fill(y.begin(), y.end(), 0.0);
      y[work.joints[i - work.rows]] = 1.0;
    }
    solve_mass<double>(model, work.data, y);
    for (std::size_t j = 0; j <= i; ++j) {
      work.G[i * capacity + j] = work.G[j * capacity + i] = work.along(j, y);
    }
  }
  for (std::size_t i = 0; i < n; ++i) {
    const bool zero = i < work.rows && largest_of(work.row_of_J(i)) <= kZeroRow * work.magnitude[i];
    work.floor[i] = zero ? std::numeric_limits<double>::infinity() : 0.0;
  }
}

void solve_rows(ConstraintWork& work, std::span<double> p) {
  const std::size_t n = work.in_use();
  work.cholesky.factor(work.G, n, work.capacity(), work.floor);
  std::fill(p.begin(), p.end(), 0.0);
  std::copy_n(work.rhs.begin(), n, work.left.begin());
  for (int iteration = 0; iteration < 2; ++iteration) {
    work.cholesky.solve(std::span(work.left).first(n));
    for (std::size_t i = 0; i < n; ++i) p[i] += work.left[i];
    for (std::size_t i = 0; i < n; ++i) {
      double sum = work.rhs[i];
      for (std::size_t j = 0; j < n; ++j) sum -= work.G[i * work.capacity() + j] * p[j];
      work.left[i] = sum;
    }
  }
}

// The scale is the largest term in any row of the same constraint: in a row of zeros all terms are
// rounding.
bool contradicted(const ConstraintWork& work) {
  std::size_t first = 0;
  for (const ConstraintPtr& constraint : work.set.constraints()) {
    const auto count = static_cast<std::size_t>(constraint->rows());
    const double scale = largest_of(std::span(work.terms).subspan(first, count));
    const double left = largest_of(std::span(work.left).subspan(first, count));
    if (!(left <= kContradiction * scale + 1e-12)) return true;
    first += count;
  }
  return false;
}

tl::unexpected<Error> contradiction(const char* call) {
  return tl::make_unexpected(
      Error{Errc::singular,
            std::string(call) +
                ": the constraints contradict each other in this configuration; remove one, or "
                "bring q and v onto them first (close_loops, project_velocities)"});
}

void add_response(const ConstraintWork& work, std::span<const double> p, std::span<double> x) {
  for (std::size_t i = 0; i < work.in_use(); ++i) {
    for (std::size_t k = 0; k < work.velocities; ++k)
      x[k] += work.Y[i * work.velocities + k] * p[i];
  }
}

namespace {

// Whether every residual is within the tolerance. size > 0, the mechanism's size [m], also accepts
// residuals at the level of rounding.
bool closed(const ConstraintWork& work, double tolerance, double size) {
  for (std::size_t i = 0; i < work.rows; ++i) {
    const double rounding = 1e-14 * size * std::max(1.0, work.magnitude[i]);
    if (!(std::fabs(work.phi[i]) <= std::max(tolerance, rounding))) return false;
  }
  return true;
}
double size_of(const Model& model, const ConstraintWork& work, std::span<const double> q) {
  double size = largest_of(q);
  for (int link = 0; link < model.links(); ++link) {
    const Vec3 p = T_world_link<double>(model, work.data, link).position();
    size = std::max({size, std::fabs(p.x), std::fabs(p.y), std::fabs(p.z)});
  }
  return size;
}

double square_of(std::span<const double> x) {
  double sum = 0.0;
  for (const double value : x) sum += value * value;
  return sum;
}

void evaluate_at(const Model& model, ConstraintWork& work, std::span<const double> q) {
  forward_kinematics<double>(model, work.data, q, work.v_zero);
  evaluate_rows(model, work, q, work.v_zero);
}

// Line search: halves the step until the residuals decrease. If they do not decrease, takes the
// full step: a residual may have to grow temporarily. phi and J are then those of q.
void take_step(const Model& model, ConstraintWork& work, std::span<double> q) {
  const double before = square_of(work.phi);
  const auto go = [&](double fraction) {
    for (double& x : work.step) x *= fraction;
    integrate<double>(model, q, work.step, work.q_trial);
    evaluate_at(model, work, work.q_trial);
    return square_of(work.phi) < before;
  };
  double fraction = 1.0;
  bool better = go(1.0);
  while (!better && fraction > 0.01) {
    better = go(0.5);
    fraction *= 0.5;
  }
  if (!better) go(1.0 / fraction);
  std::copy(work.q_trial.begin(), work.q_trial.end(), q.begin());
}

}  // namespace

Expected<int> close(const Model& model, ConstraintWork& work, std::span<double> q, double tolerance,
                    int max_steps) {
  evaluate_at(model, work, q);
  double before = std::numeric_limits<double>::infinity();
  for (int taken = 0; taken <= max_steps; ++taken) {
    if (closed(work, tolerance, 0.0)) return taken;
    const double now = square_of(work.phi);
    if (now > 0.25 * before && closed(work, tolerance, size_of(model, work, q))) return taken;
    before = now;
    if (taken == max_steps) break;
    if (auto fine = factor_mass<double>(model, work.data, q); !fine) {
      return tl::make_unexpected(fine.error());
    }
    respond(model, work);
    for (std::size_t i = 0; i < work.in_use(); ++i) {
      work.rhs[i] = i < work.rows ? -work.phi[i] : 0.0;
    }
    solve_rows(work, work.lambda);
    std::fill(work.step.begin(), work.step.end(), 0.0);
    add_response(work, work.lambda, work.step);
    for (const std::size_t i : work.joints) work.step[i] = 0.0;  // exactly zero
    if (!std::isfinite(largest_of(work.step)) || !(largest_of(work.step) < 1e100)) break;
    take_step(model, work, q);
  }
  return tl::make_unexpected(
      Error{Errc::singular,
            "close_loops: the constraints cannot be met from this configuration; start nearer, "
            "hold fewer joints, or look for constraints that contradict each other"});
}

}  // namespace detail

ConstrainedData::ConstrainedData(const Model& model, ConstraintSet constraints)
    : work_(std::make_unique<detail::ConstraintWork>(model, std::move(constraints))) {}
ConstrainedData::~ConstrainedData() = default;
ConstrainedData::ConstrainedData(ConstrainedData&&) noexcept = default;
ConstrainedData& ConstrainedData::operator=(ConstrainedData&&) noexcept = default;

Data& ConstrainedData::links() {
  return work_->data;
}
std::span<const double> ConstrainedData::residual() const {
  return work_->phi;
}
std::span<const double> ConstrainedData::jacobian() const {
  return work_->J;
}
std::span<const double> ConstrainedData::bias() const {
  return work_->bias;
}
std::span<const double> ConstrainedData::multipliers() const {
  return std::span<const double>(work_->lambda).first(work_->rows);
}
int ConstrainedData::rank() const {
  return static_cast<int>(work_->cholesky.rank());
}

void evaluate_constraints(const Model& model, ConstrainedData& data, std::span<const double> q,
                          std::span<const double> v) {
  forward_kinematics<double>(model, data.work().data, q, v);
  detail::evaluate_rows(model, data.work(), q, v);
}

Expected<void> constrained_forward_dynamics(const Model& model, ConstrainedData& data,
                                            std::span<const double> q, std::span<const double> v,
                                            std::span<const double> tau, const Loads& loads,
                                            double rate, std::span<double> a) {
  detail::ConstraintWork& work = data.work();
  VP_ASSERT(v.size() == work.velocities && a.size() == work.velocities);
  work.joints.clear();
  if (auto fine = forward_dynamics<double>(model, work.data, q, v, tau, loads, a); !fine) {
    return fine;
  }
  detail::evaluate_rows(model, work, q, v);
  detail::respond(model, work);
  for (std::size_t i = 0; i < work.rows; ++i) {
    const double free = work.along(i, a), speed = work.along(i, v);
    const double fade = 2 * rate * speed + rate * rate * work.phi[i];
    work.rhs[i] = -(work.bias[i] + fade + free);
    work.terms[i] = std::fabs(work.bias[i]) + std::fabs(free) + 2 * rate * std::fabs(speed) +
                    rate * rate * std::fabs(work.phi[i]);
  }
  detail::solve_rows(work, work.lambda);
  if (detail::contradicted(work)) return detail::contradiction("constrained_forward_dynamics");
  detail::add_response(work, work.lambda, a);
  return {};
}

Expected<int> close_loops(const Model& model, ConstrainedData& data, std::span<double> q,
                          const ClosureOptions& options) {
  detail::ConstraintWork& work = data.work();
  VP_ASSERT(q.size() == work.q_trial.size());
  work.joints.clear();
  for (const int i : options.held) {
    VP_ASSERT(i >= 0 && i < model.velocities());
    work.joints.push_back(static_cast<std::size_t>(i));
  }
  return detail::close(model, work, q, options.tolerance, options.max_steps);
}

Expected<void> project_velocities(const Model& model, ConstrainedData& data,
                                  std::span<const double> q, std::span<double> v) {
  detail::ConstraintWork& work = data.work();
  VP_ASSERT(v.size() == work.velocities);
  work.joints.clear();
  detail::evaluate_at(model, work, q);
  if (auto fine = factor_mass<double>(model, work.data, q); !fine) return fine;
  detail::respond(model, work);
  for (std::size_t i = 0; i < work.rows; ++i) work.rhs[i] = -work.along(i, v);
  detail::solve_rows(work, work.lambda);
  detail::add_response(work, work.lambda, v);
  return {};
}

}  // namespace vp
