#include "solve/dense_island.h"

#include <algorithm>
#include <cmath>

#include "solve/dense_passes.h"
#include "solve/fours.h"
#include "solve/impulses.h"

namespace vp::solve {
namespace {

// e, the regularization as a fraction of the diagonal: its initial and minimum value, its growth
// and its decay factor.
constexpr double kAtBound = 1e-6, kAtBoundGrowth = 30.0, kAtBoundShrink = 10.0;
// The maximum number of Newton steps per island, and of consecutive rejected ones.
constexpr int kMaxSteps = 24, kMaxRejected = 3;
// The number of step fractions that are tried: 1, 1/2, and so on.
constexpr int kFractions = 5;
// If the last iteration still changes speeds by more than kContradicts [m/s], the rows contradict
// one another. No contact makes anything kThrown times faster than the initial speeds and the
// targets. If the load has meanwhile grown by more than kGrown, the impulses are not used as a warm
// start.
constexpr double kContradicts = 0.01;
constexpr double kThrown = 10.0;
constexpr double kGrown = 1.5;

}  // namespace

DenseIsland::DenseIsland(const StepContext& s, const Islands& islands, const Island& island,
                         DenseScratch& scratch)
    : s_(s),
      joints_(islands.joints(island)),
      stride_(in_fours(island.rows)),
      factor_(scratch.factor),
      size_(static_cast<std::uint32_t>(joints_.size())) {
  for (const std::uint32_t k : islands.contacts(island)) {
    contacts_[contact_count_++] = {&s.contacts[k], size_};
    size_ += static_cast<std::uint32_t>(rows_of(s.contacts[k]));
  }
  write_dense_matrix(s, islands, island, scratch);
  W_ = scratch.matrix.data();
}

void DenseIsland::read() {
  for (std::uint32_t r = 0; r < joints_.size(); ++r) {
    const JointRow& row = s_.joints[joints_[r]];
    p_[r] = row.impulse;
    u_[r] = speed_of(s_, row);
  }
  for (std::uint32_t k = 0; k < contact_count_; ++k) {
    const ContactConstraint& c = *contacts_[k].constraint;
    const SolverBody &a = s_.bodies[c.a], &b = s_.bodies[c.b];
    for (int i = 0; i < c.count; ++i) {
      const ContactPoint& p = c.points[i];
      const int own = row_of(i, kNormal);
      const std::uint32_t r = contacts_[k].row + static_cast<std::uint32_t>(own);
      const PointSpeeds u = speeds_of(a, b, c, p);
      p_[r] = p.normal_impulse;
      p_[r + 1] = p.tangent_impulse[0];
      p_[r + 2] = p.tangent_impulse[1];
      for (int displacement = 0; displacement < kRowsOfPoint; ++displacement) {
        u_[r + static_cast<std::uint32_t>(displacement)] =
            u.along[displacement] + through_links(c, own + displacement);
      }
    }
    if (c.rolling <= 0.0) continue;
    const std::uint32_t r = contacts_[k].row_of_rolling();
    const int own = row_of(c.count, 0);
    const Vec3 turning = b.w - a.w;
    for (int axis = 0; axis < 3; ++axis) {
      const std::uint32_t at = r + static_cast<std::uint32_t>(axis);
      p_[at] = c.rolling_impulse[axis];
      u_[at] = turning[axis] + through_links(c, own + axis);
    }
  }
  for (std::size_t r = size_; r < stride_; ++r) u_[r] = 0.0;
  start_ = p_;
}

void DenseIsland::write() {
  for (std::uint32_t r = 0; r < joints_.size(); ++r) {
    JointRow& row = s_.joints[joints_[r]];
    row.impulse = p_[r];
    give(s_, row, p_[r] - start_[r]);
  }
  for (std::uint32_t k = 0; k < contact_count_; ++k) {
    ContactConstraint& c = *contacts_[k].constraint;
    SolverBody &a = s_.bodies[c.a], &b = s_.bodies[c.b];
    for (int i = 0; i < c.count; ++i) {
      ContactPoint& p = c.points[i];
      const int own = row_of(i, kNormal);
      const std::uint32_t r = contacts_[k].row + static_cast<std::uint32_t>(own);
      p.normal_impulse = p_[r];
      p.tangent_impulse[0] = p_[r + 1];
      p.tangent_impulse[1] = p_[r + 2];
      const double n = p_[r] - start_[r], t0 = p_[r + 1] - start_[r + 1],
                   t1 = p_[r + 2] - start_[r + 2];
      if (n == 0.0 && t0 == 0.0 && t1 == 0.0) continue;
      apply(a, b, c, p, n * c.normal + t0 * c.tangent[0] + t1 * c.tangent[1]);
      apply_to_links(c, own, n);
      apply_to_links(c, own + 1, t0);
      apply_to_links(c, own + 2, t1);
    }
    if (!contacts_[k].rolls()) continue;
    const std::uint32_t r = contacts_[k].row_of_rolling();
    const Vec3 now{p_[r], p_[r + 1], p_[r + 2]};
    apply_moment(a, b, c, now - c.rolling_impulse);
    c.rolling_impulse = now;
  }
}

inline void DenseIsland::change(std::uint32_t row, double by) {
  if (by == 0.0) return;
  const double size = W_[row * stride_ + row] * std::fabs(by);
  if (!(size <= max_) && !std::isnan(max_)) max_ = size;  // NaN persists
  p_[row] += by;
  add_scaled(u_.data(), W_ + row * stride_, by, stride_);
}

double DenseIsland::joint_after(std::uint32_t r) const {
  return impulse_after(s_.joints[joints_[r]], p_[r], u_[r]);
}
double DenseIsland::normal_after(const ContactPoint& p, std::uint32_t r) const {
  return std::max(0.0, p_[r] + p.normal_mass * (p.target - u_[r]));
}

double DenseIsland::load(const Contact& contact) const {
  double sum = 0.0;
  for (int i = 0; i < contact.constraint->count; ++i) {
    sum += p_[contact.row + static_cast<std::uint32_t>(row_of(i, kNormal))];
  }
  return sum;
}

void DenseIsland::solve_rolling(const Contact& contact) {
  const ContactConstraint& c = *contact.constraint;
  const std::uint32_t r = contact.row_of_rolling();
  const Vec3 next =
      rolling_after(c, {p_[r], p_[r + 1], p_[r + 2]}, {u_[r], u_[r + 1], u_[r + 2]}, load(contact));
  for (int axis = 0; axis < 3; ++axis) {
    const std::uint32_t at = r + static_cast<std::uint32_t>(axis);
    change(at, next[axis] - p_[at]);
  }
}

void DenseIsland::solve_friction(const ContactConstraint& c, const ContactPoint& p,
                                 std::uint32_t r) {
  double next[2] = {p_[r + 1], p_[r + 2]};
  friction_after(c, p, u_[r + 1] - c.surface_speed[0], u_[r + 2] - c.surface_speed[1], p_[r], next);
  const double t0 = next[0] - p_[r + 1], t1 = next[1] - p_[r + 2];
  change(r + 1, t0);
  change(r + 2, t1);
}

// Returns the maximum change of a row's speed by its own impulse.
double DenseIsland::eliminate(bool forward) {
  max_ = 0.0;
  for (std::uint32_t r = 0; r < joints_.size(); ++r) change(r, joint_after(r) - p_[r]);
  for (std::uint32_t k = 0; k < contact_count_; ++k) {
    const Contact& contact = contacts_[forward ? k : contact_count_ - 1 - k];
    const ContactConstraint& c = *contact.constraint;
    if (contact.rolls()) solve_rolling(contact);
    for (int i = 0; i < c.count; ++i) {
      solve_friction(c, c.points[i], contact.row + static_cast<std::uint32_t>(row_of(i, kNormal)));
    }
    for (int i = 0; i < c.count; ++i) {
      const std::uint32_t r = contact.row + static_cast<std::uint32_t>(row_of(i, kNormal));
      change(r, normal_after(c.points[i], r) - p_[r]);
    }
  }
  return max_;
}

void DenseIsland::add_equation(std::uint32_t row, double error, double softness) {
  equations_[free_count_++] = {row, {}, {}, 0.0, softness, error};
}

void DenseIsland::add_disc(const Disc& disc, double load) {
  const double max_value = disc.friction * load;
  if (max_value <= 0.0 || disc.mass <= 0.0) return;
  double q[3]{}, square = 0.0;
  for (std::uint32_t k = 0; k < disc.size; ++k) {
    q[k] = p_[disc.row + k] - disc.mass * disc.speed[k];
    square += q[k] * q[k];
  }
  const bool within = square <= max_value * max_value;
  const double size = std::sqrt(square);
  for (std::uint32_t k = 0; k < disc.size; ++k) {
    if (within) {
      add_equation(disc.row + k, -disc.speed[k], 0.0);
      continue;
    }
    Equation& e = sliding_[sliding_count_++];
    e = {disc.row + k, disc, {}, max_value / size, 1.0 / disc.mass, 0.0};
    for (std::uint32_t n = 0; n < disc.size; ++n) e.direction[n] = q[n] / size;
    e.error = (max_value * e.direction[k] - p_[e.row]) / disc.mass;
  }
}

// Sets up the equations of the rows that are not at a bound, with their right-hand sides. Sliding
// rows come last: the equations before them are symmetric.
void DenseIsland::find_equations() {
  free_count_ = sliding_count_ = 0;
  for (std::uint32_t r = 0; r < joints_.size(); ++r) {
    const JointRow& row = s_.joints[joints_[r]];
    if (p_[r] <= row.lower || p_[r] >= row.upper || row.mass == 0.0) continue;
    add_equation(r, row.target - u_[r] - row.softness * p_[r], row.softness);
  }
  for (std::uint32_t k = 0; k < contact_count_; ++k) {
    const Contact& contact = contacts_[k];
    const ContactConstraint& c = *contact.constraint;
    for (int i = 0; i < c.count; ++i) {
      const ContactPoint& p = c.points[i];
      const std::uint32_t r = contact.row + static_cast<std::uint32_t>(row_of(i, kNormal));
      if (p_[r] <= 0.0 || p.normal_mass == 0.0) continue;
      add_equation(r, p.target - u_[r], 0.0);
      add_disc({r + 1,
                2,
                r,
                1,
                c.friction,
                p.slide_mass,
                {u_[r + 1] - c.surface_speed[0], u_[r + 2] - c.surface_speed[1], 0.0}},
               p_[r]);
    }
    if (!contact.rolls()) continue;
    const std::uint32_t r = contact.row_of_rolling();
    add_disc({r,
              3,
              contact.row,
              static_cast<std::uint32_t>(c.count),
              c.rolling,
              c.rolling_mass,
              {u_[r], u_[r + 1], u_[r + 2]}},
             load(contact));
  }
  symmetric_count_ = free_count_;
  for (std::uint32_t i = 0; i < sliding_count_; ++i) equations_[free_count_++] = sliding_[i];
  for (std::uint32_t i = 0; i < free_count_; ++i) {
    free_[i] = equations_[i].row;
    step_[i] = equations_[i].error;
  }
}

void DenseIsland::write_equation(std::size_t i, double* A) const {
  const Equation& e = equations_[i];
  const double* const W = W_ + e.row * stride_;
  if (e.disc.size == 0) {
    for (std::size_t j = 0; j < free_count_; ++j) A[j] = W[free_[j]];
    A[i] += at_bound_ * W[e.row] + e.softness;
    return;
  }
  // The rotation of the sliding direction: P = 1 - d d^T projects perpendicular to it.
  const Disc& disc = e.disc;
  const std::uint32_t own = e.row - disc.row;
  double P[3]{};
  for (std::uint32_t k = 0; k < disc.size; ++k) {
    P[k] = e.turning * ((own == k ? 1.0 : 0.0) - e.direction[own] * e.direction[k]);
  }
  for (std::size_t j = 0; j < free_count_; ++j) {
    const std::uint32_t column = free_[j];
    A[j] = 0.0;
    for (std::uint32_t k = 0; k < disc.size; ++k)
      A[j] += P[k] * W_[(disc.row + k) * stride_ + column];
    if (disc.is_pressed_by(column)) A[j] -= e.softness * disc.friction * e.direction[own];
    if (disc.has(column)) A[j] -= e.softness * P[column - disc.row];
  }
  A[i] += e.softness;
}

// Gaussian elimination. Of the symmetric part, which is positive definite, only the upper triangle
// is updated. The rest uses partial pivoting. Returns false if a pivot is zero or the solution is
// not finite.
bool DenseIsland::solve_directly() {
  find_equations();
  const std::size_t n = free_count_, stride = in_fours(n);
  if (n == 0) return false;
  if (factor_.size() < n * stride) factor_.resize(n * stride);
  std::array<double*, kMaxRows> A;
  for (std::size_t i = 0; i < n; ++i) {
    A[i] = factor_.data() + i * stride;
    write_equation(i, A[i]);
    for (std::size_t j = n; j < stride; ++j) A[i][j] = 0.0;
  }
  if (!dense_passes().solve({A.data(), step_.data(), n, symmetric_count_, stride})) return false;
  return std::all_of(step_.begin(), step_.begin() + n, [](double x) { return std::isfinite(x); });
}

// Adds a fraction of the step to the current impulses and projects them onto their bounds.
void DenseIsland::go(double fraction) {
  Rows next = p_;
  for (std::size_t i = 0; i < free_count_; ++i) next[free_[i]] += fraction * step_[i];
  project(next);
  for (std::uint32_t r = 0; r < size_; ++r) change(r, next[r] - p_[r]);
}

// The sum of the squares of the speed changes that each row would make on its own.
double DenseIsland::error() const {
  double sum = 0.0;
  const auto add = [&](std::uint32_t r, double by) {
    const double speed = W_[r * stride_ + r] * by;
    sum += speed * speed;
  };
  for (std::uint32_t r = 0; r < joints_.size(); ++r) add(r, joint_after(r) - p_[r]);
  for (std::uint32_t k = 0; k < contact_count_; ++k) {
    const Contact& contact = contacts_[k];
    const ContactConstraint& c = *contact.constraint;
    for (int i = 0; i < c.count; ++i) {
      const std::uint32_t r = contact.row + static_cast<std::uint32_t>(row_of(i, kNormal));
      const ContactPoint& p = c.points[i];
      double next[2] = {p_[r + 1], p_[r + 2]};
      friction_after(c, p, u_[r + 1] - c.surface_speed[0], u_[r + 2] - c.surface_speed[1], p_[r],
                     next);
      add(r, normal_after(p, r) - p_[r]);
      add(r + 1, next[0] - p_[r + 1]);
      add(r + 2, next[1] - p_[r + 2]);
    }
    if (!contact.rolls()) continue;
    const std::uint32_t r = contact.row_of_rolling();
    const Vec3 next = rolling_after(c, {p_[r], p_[r + 1], p_[r + 2]}, {u_[r], u_[r + 1], u_[r + 2]},
                                    load(contact));
    for (std::uint32_t axis = 0; axis < 3; ++axis)
      add(r + axis, next[static_cast<int>(axis)] - p_[r + axis]);
  }
  return sum;
}

// Projects impulses onto their bounds.
void DenseIsland::project(Rows& x) const {
  for (std::uint32_t r = 0; r < joints_.size(); ++r) {
    const JointRow& row = s_.joints[joints_[r]];
    x[r] = std::clamp(x[r], row.lower, row.upper);
  }
  for (std::uint32_t k = 0; k < contact_count_; ++k) {
    const Contact& contact = contacts_[k];
    const ContactConstraint& c = *contact.constraint;
    double sum = 0.0;
    for (int i = 0; i < c.count; ++i) {
      const std::uint32_t r = contact.row + static_cast<std::uint32_t>(row_of(i, kNormal));
      x[r] = std::max(0.0, x[r]);
      sum += x[r];
      const double max_value = c.friction * x[r];
      const double size = std::sqrt(x[r + 1] * x[r + 1] + x[r + 2] * x[r + 2]);
      if (size <= max_value) continue;
      x[r + 1] *= max_value / size;
      x[r + 2] *= max_value / size;
    }
    if (!contact.rolls()) continue;
    const std::uint32_t r = contact.row_of_rolling();
    const double max_value = c.rolling * sum;
    const double size = std::sqrt(x[r] * x[r] + x[r + 1] * x[r + 1] + x[r + 2] * x[r + 2]);
    if (size <= max_value) continue;
    for (std::uint32_t axis = 0; axis < 3; ++axis) x[r + axis] *= max_value / size;
  }
}

// The sum of the normal impulses.
double DenseIsland::load() const {
  double sum = 0.0;
  for (std::uint32_t k = 0; k < contact_count_; ++k) sum += load(contacts_[k]);
  return sum;
}

double DenseIsland::fastest() const {
  double max_value = 0.0;
  for (std::uint32_t r = 0; r < size_; ++r) max_value = std::max(max_value, std::fabs(u_[r]));
  return max_value;
}

double DenseIsland::fastest_target() const {
  double max_value = 0.0;
  for (const std::uint32_t j : joints_)
    max_value = std::max(max_value, std::fabs(s_.joints[j].target));
  for (std::uint32_t k = 0; k < contact_count_; ++k) {
    const ContactConstraint& c = *contacts_[k].constraint;
    for (int i = 0; i < c.count; ++i)
      max_value = std::max(max_value, std::fabs(c.points[i].target));
  }
  return max_value;
}

void DenseIsland::forget() {
  for (std::uint32_t k = 0; k < contact_count_; ++k) contacts_[k].constraint->consistent = false;
}

// Takes the first fraction of the Newton step that reduces the error enough. Returns false and
// changes nothing if none does.
bool DenseIsland::step() {
  if (!solve_directly()) return false;
  const Rows p = p_, u = u_;
  const double before = error();
  double fraction = 1.0;
  for (int k = 0; k < kFractions; ++k, fraction *= 0.5) {
    go(fraction);
    if (error() < (1.0 - 0.5 * fraction) * before) return true;
    p_ = p;
    u_ = u;
  }
  return false;
}

// After a rejected step, plain iterations follow, twice as many each time, and the next step is
// shorter. Where walls close on a body between them, no impulses are consistent: steps and
// iterations only increase them, steps by far more. Such an island returns to the state before the
// first step and uses iterations alone. If its load still grows, its impulses are not used as a
// warm start, since they would grow from step to step.
void DenseIsland::iterate(int iterations) {
  read();
  const double target = std::max(fastest(), fastest_target()), load_before = load();
  Rows p_first{}, u_first{};
  double before = 0.0;  // the change in the last iteration
  int next = 1, wait = 1, steps = 0, refused = 0;
  bool converged = false;
  at_bound_ = kAtBound;
  for (int i = 0; i < iterations && !converged; ++i) {
    if (i >= next && i + 1 < iterations && steps < kMaxSteps && refused < kMaxRejected) {
      if (steps++ == 0) {
        p_first = p_;
        u_first = u_;
      }
      if (step()) {
        at_bound_ = std::max(kAtBound, at_bound_ / kAtBoundShrink);
        refused = 0;
      } else {
        next = i + 1 + wait;
        wait *= 2;
        ++refused;
        at_bound_ *= kAtBoundGrowth;
      }
    }
    before = eliminate(i % 2 == 0);
    converged = before < convergence_tolerance(s_);
  }
  if (steps > 0 && ((!converged && before > kContradicts) || fastest() > kThrown * target)) {
    p_ = p_first;
    u_ = u_first;
    converged = false;
    for (int i = 0; i < iterations && !converged; ++i)
      converged = eliminate(i % 2 == 0) < convergence_tolerance(s_);
    if (!converged && load() > kGrown * load_before) forget();
  }
  write();
}

}  // namespace vp::solve
