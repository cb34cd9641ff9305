#include "multibody/force_law_solver.h"

#include <algorithm>
#include <cmath>

namespace vp::detail {
namespace {

// A diagonal entry of G below this fraction of its value before the constraints is rounding: the
// joint cannot move by itself.
constexpr double kNoFreedom = 1e-12;
constexpr double kExact = 1e-13;  // relative to the terms in a velocity, whose sums round at 1e-16
constexpr int kMaxIterations = 100;
constexpr int kHalvings = 40;
// Factors of caution after a failed Newton step, in a cycle: a bold step may select the same wrong
// pieces again, and a cautious step corrects few of them (docs/decisions/0015).
constexpr double kNewtonDamping[8] = {1, 1, 16, 1, 256, 1, 4096, 1};

}  // namespace

ForceLawSolver::ForceLawSolver(std::size_t n)
    : capacity(n),
      G(n * n),
      w_free(n),
      self(n),
      force_laws(n),
      p(n),
      w(n),
      on(n),
      D_(n),
      scale_(n),
      best_(n),
      direction_(n),
      bend_(n),
      A_(n * n),
      rhs_(n),
      floor_(n),
      cholesky_(n) {
  active_.reserve(n);
}

void ForceLawSolver::find_w() {
  for (std::size_t i = 0; i < size; ++i) {
    double sum = w_free[i], terms = std::fabs(w_free[i]);
    for (std::size_t j = 0; j < size; ++j) {
      const double term = G[i * capacity + j] * p[j];
      sum += term;
      terms += std::fabs(term);
    }
    w[i] = sum;
    scale_[i] = terms;
  }
}

// Finds the piece of each joint with all other joints fixed. Returns the largest relative change of
// p. More caution keeps each joint closer to its current p, since all change at once.
double ForceLawSolver::update_active_pieces(double caution) {
  double worst = 0.0;
  for (std::size_t i = 0; i < size; ++i) {
    const double D = caution * D_[i];
    on[i] = force_laws[i].intersect(w[i] - D * p[i], D);
    const double away = D * std::fabs(on[i].p - p[i]);
    if (away > 0.0) worst = std::max(worst, away / (scale_[i] + D * std::fabs(on[i].p)));
  }
  return worst;
}

// Solves with all joints on their current pieces.
void ForceLawSolver::newton() {
  active_.clear();
  for (std::size_t i = 0; i < size; ++i) {
    if (on[i].at_step || on[i].beta > 0.0) {
      active_.push_back(i);
    } else {
      p[i] = on[i].alpha;
    }
  }
  const std::size_t n = active_.size();
  for (std::size_t a = 0; a < n; ++a) {
    const std::size_t i = active_[a];
    const double softness = on[i].at_step ? 0.0 : 1.0 / on[i].beta;
    double sum = (on[i].at_step ? on[i].w : on[i].alpha * softness) - w_free[i];
    for (std::size_t j = 0; j < size; ++j) {
      const bool known = !on[j].at_step && !(on[j].beta > 0.0);
      if (known) sum -= G[i * capacity + j] * p[j];
    }
    rhs_[a] = sum;
    for (std::size_t b = 0; b < n; ++b) A_[a * capacity + b] = G[i * capacity + active_[b]];
    A_[a * capacity + a] += softness;
    floor_[a] = kNoFreedom * self[i];
  }
  cholesky_.factor(A_, n, capacity, floor_);
  cholesky_.solve(std::span(rhs_).first(n));
  for (std::size_t a = 0; a < n; ++a) p[active_[a]] = rhs_[a];
}

// Line search from best_ towards p, to the minimum of the energy E. The derivative E' increases
// along it.
void ForceLawSolver::line_search() {
  for (std::size_t i = 0; i < size; ++i)
    direction_[i] = force_laws[i].clamped_impulse(p[i]) - best_[i];
  for (std::size_t i = 0; i < size; ++i) {
    double at_start = w_free[i], bend = 0.0;
    for (std::size_t j = 0; j < size; ++j) {
      at_start += G[i * capacity + j] * best_[j];
      bend += G[i * capacity + j] * direction_[j];
    }
    w[i] = at_start;
    bend_[i] = bend;
  }
  const auto slope = [&](double t) {
    double sum = 0.0;
    for (std::size_t i = 0; i < size; ++i) {
      if (direction_[i] == 0.0) continue;
      sum += direction_[i] *
             (w[i] + t * bend_[i] - force_laws[i].velocity_for(best_[i] + t * direction_[i]));
    }
    return sum;
  };
  double from = 0.0, to = 1.0;
  for (int i = 0; i < kHalvings; ++i) {
    const double half = 0.5 * (from + to);
    (slope(half) < 0.0 ? from : to) = half;
  }
  for (std::size_t i = 0; i < size; ++i) p[i] = best_[i] + from * direction_[i];
}

void ForceLawSolver::sweep() {
  for (std::size_t i = 0; i < size; ++i) {
    double sum = w_free[i];
    for (std::size_t j = 0; j < size; ++j) sum += G[i * capacity + j] * p[j];
    p[i] = force_laws[i].intersect(sum - D_[i] * p[i], D_[i]).p;
  }
}

int ForceLawSolver::solve() {
  for (std::size_t i = 0; i < size; ++i) {
    D_[i] = std::max(G[i * capacity + i], kNoFreedom * self[i]);
  }
  find_w();
  off_ = update_active_pieces(1.0);
  int iteration = 0;
  for (; iteration < kMaxIterations && !(off_ <= kExact); ++iteration) {
    std::copy_n(p.begin(), size, best_.begin());
    newton();
    find_w();
    const double now = update_active_pieces(1.0);
    if (now <= 0.01 * off_) {
      off_ = now;
      continue;
    }
    line_search();
    sweep();
    find_w();
    off_ = update_active_pieces(kNewtonDamping[iteration % 8]);
  }
  return iteration;
}

}  // namespace vp::detail
