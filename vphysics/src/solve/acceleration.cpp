#include "solve/acceleration.h"

#include <algorithm>
#include <cmath>

#include "solve/impulses.h"

namespace vp::solve {
namespace {

// Rounds that come first: what converges at once is left alone.
constexpr int kFirst = 2;
// Rounds that follow the last change at least: the next sweep may take it back.
constexpr int kLast = 8;
// Of the square of a difference what is left beside the others; less is rounding.
constexpr double kIndependent = 1e-9;

// f(impulse, mass) for each row.
template <class F>
void for_rows(const StepContext& s, const F& f) {
  for (const ContactConstraint& c : s.contacts) {
    for (int i = 0; i < c.count; ++i) {
      const ContactPoint& p = c.points[i];
      f(p.normal_impulse, p.normal_mass);
      f(p.tangent_impulse[0], p.slide_mass);
      f(p.tangent_impulse[1], p.slide_mass);
    }
    if (c.rolling_mass <= 0.0) continue;
    for (int k = 0; k < 3; ++k) f(c.rolling_impulse[k], c.rolling_mass);
  }
  for (const JointRow& row : s.joints) {
    if (s.articulations[row.articulation].touched) f(row.impulse, row.mass);
  }
}

// Solves A x = b by Cholesky's factors, of the first n rows and columns; A is given by its lower
// triangle. What depends on those before it gets 0.
template <std::size_t N>
void solve_positive(double (&A)[N][N], std::array<double, N>& b, std::size_t n) {
  for (std::size_t i = 0; i < n; ++i) {
    const double square = A[i][i];
    for (std::size_t j = 0; j <= i; ++j) {
      double x = A[i][j];
      for (std::size_t k = 0; k < j; ++k) x -= A[i][k] * A[j][k];
      if (i == j) {
        A[i][i] = x > kIndependent * square ? std::sqrt(x) : 0.0;
      } else {
        A[i][j] = A[j][j] > 0.0 ? x / A[j][j] : 0.0;
      }
    }
    double x = b[i];
    for (std::size_t k = 0; k < i; ++k) x -= A[i][k] * b[k];
    b[i] = A[i][i] > 0.0 ? x / A[i][i] : 0.0;
  }
  for (std::size_t i = n; i-- > 0;) {
    double x = b[i];
    for (std::size_t k = i + 1; k < n; ++k) x -= A[k][i] * b[k];
    b[i] = A[i][i] > 0.0 ? x / A[i][i] : 0.0;
  }
}

}  // namespace

void Acceleration::read(Rows& impulses) const {
  std::size_t k = 0;
  for_rows(s_, [&](double impulse, double) { impulses[k++] = impulse; });
}

void Acceleration::begin() {
  std::size_t count = 0;
  for_rows(s_, [&](double, double) { ++count; });
  rows_ = count;
  if (rows_ > kMaxRows) return;
  std::size_t k = 0;
  for_rows(s_, [&](double, double mass) { response_[k++] = mass > 0.0 ? 1.0 / mass : 0.0; });
  read(x_);
}

double Acceleration::product(const Rows& a, const Rows& b) const {
  double sum = 0.0;
  for (std::size_t k = 0; k < rows_; ++k) sum += response_[k] * a[k] * b[k];
  return sum;
}

void Acceleration::remember(const Rows& f) {
  if (has_last_) {
    Rows &dx = dx_[next_], &df = df_[next_];
    for (std::size_t k = 0; k < rows_; ++k) {
      dx[k] = x_[k] - last_x_[k];
      df[k] = f[k] - last_f_[k];
    }
    next_ = (next_ + 1) % kDepth;
    known_ = std::min(known_ + 1, kDepth);
  }
  has_last_ = true;
  last_x_ = x_;
  last_f_ = f;
}

void Acceleration::forget() {
  has_last_ = changed_ = false;
  known_ = next_ = 0;
}

std::array<double, Acceleration::kDepth> Acceleration::coefficients(const Rows& f) const {
  double A[kDepth][kDepth];
  std::array<double, kDepth> c{};
  for (std::size_t i = 0; i < known_; ++i) {
    for (std::size_t j = 0; j <= i; ++j) A[i][j] = product(df_[i], df_[j]);
    c[i] = product(df_[i], f);
  }
  solve_positive(A, c, known_);
  return c;
}

void Acceleration::add(const Rows& change) const {
  std::size_t k = 0;
  for (ContactConstraint& c : s_.contacts) {
    SolverBody &a = s_.bodies[c.a], &b = s_.bodies[c.b];
    for (int i = 0; i < c.count; ++i, k += 3) {
      ContactPoint& p = c.points[i];
      const double normal = std::max(-p.normal_impulse, change[k]);
      p.normal_impulse += normal;
      p.tangent_impulse[0] += change[k + 1];
      p.tangent_impulse[1] += change[k + 2];
      apply(a, b, c, p,
            normal * c.normal + change[k + 1] * c.tangent[0] + change[k + 2] * c.tangent[1]);
      apply_to_links(c, row_of(i, kNormal), normal);
      apply_to_links(c, row_of(i, kTangent), change[k + 1]);
      apply_to_links(c, row_of(i, kTangent + 1), change[k + 2]);
    }
    if (c.rolling_mass <= 0.0) continue;
    const Vec3 rolling{change[k], change[k + 1], change[k + 2]};
    k += 3;
    c.rolling_impulse += rolling;
    apply_moment(a, b, c, rolling);
  }
  for (JointRow& row : s_.joints) {
    if (!s_.articulations[row.articulation].touched) continue;
    const double next = std::clamp(row.impulse + change[k++], row.lower, row.upper);
    push(row.side, 0, next - row.impulse, row.side.velocity);
    row.impulse = next;
  }
}

// After each change the next sweep tells whether it was one for the better; if not it is taken
// back.
void Acceleration::after_sweep(int done, int rounds) {
  if (done < kFirst || rows_ > kMaxRows) return;
  if (done == kFirst) return begin();
  Rows f;
  read(f);
  for (std::size_t k = 0; k < rows_; ++k) f[k] -= x_[k];
  const double energy = product(f, f);
  if (changed_ && !(energy < last_energy_)) {
    // Back to where the last sweep had come.
    Rows back;
    for (std::size_t k = 0; k < rows_; ++k) back[k] = last_x_[k] + last_f_[k] - x_[k] - f[k];
    add(back);
    forget();
    read(x_);
    return;
  }
  remember(f);
  last_energy_ = energy;
  changed_ = known_ > 0 && done + kLast <= rounds;
  if (changed_) {
    const auto c = coefficients(f);
    Rows change;
    for (std::size_t k = 0; k < rows_; ++k) {
      change[k] = 0.0;
      for (std::size_t i = 0; i < known_; ++i) change[k] -= c[i] * (dx_[i][k] + df_[i][k]);
    }
    add(change);
  }
  read(x_);
}

}  // namespace vp::solve
