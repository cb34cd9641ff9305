// The solver's view of an articulation.
//
// An articulation is represented by a vector z, the accumulated impulses on its joints in the
// coordinates of ImpulseFactor (multibody/impulse_factor.h). An impulse p along a row adds y p to
// z, and the row's speed grows by (y, z). y is prepared once per solve. It has entries only for the
// degrees of freedom between the link and the root. The solver knows nothing else of a tree.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "multibody/impulse_factor.h"

namespace vp::solve {

struct SolverArticulation {
  detail::ImpulseFactor* factor;
  double* velocity;  // z of the velocities; written by the solver
  double* shift;     // z of the position correction; written by the solver
  bool touched;      // a contact, or a joint between bodies, acts on it; prepared
};

// The part of a contact or a joint row that acts on one articulation; empty if depth is 0.
struct LinkSide {
  const double* rows = nullptr;         // y of row 0, of row 1, ...
  const std::uint32_t* next = nullptr;  // the next degree of freedom of each, towards the root
  double* velocity = nullptr;
  double* shift = nullptr;
  std::uint32_t first = 0, depth = 0;

  const double* row(int i) const { return rows + static_cast<std::size_t>(i) * depth; }
};

// (y, z)
inline double along(const LinkSide& side, int row, const double* z) {
  const double* y = side.row(row);
  double sum = 0.0;
  for (std::uint32_t k = 0, d = side.first; k < side.depth; ++k, d = side.next[d]) {
    sum += y[k] * z[d];
  }
  return sum;
}
// z += y p
inline void apply_impulse(const LinkSide& side, int row, double p, double* z) {
  const double* y = side.row(row);
  for (std::uint32_t k = 0, d = side.first; k < side.depth; ++k, d = side.next[d]) {
    z[d] += y[k] * p;
  }
}
// The change of one row's speed by a unit impulse along another: (y, y').
inline double response(const LinkSide& side, int row, int other) {
  const double *y = side.row(row), *x = side.row(other);
  double sum = 0.0;
  for (std::uint32_t k = 0; k < side.depth; ++k) sum += y[k] * x[k];
  return sum;
}
inline bool of_one_tree(const LinkSide& a, const LinkSide& b) {
  return a.depth > 0 && b.depth > 0 && a.velocity == b.velocity;
}
// The same for rows that act on two links. Links of one articulation share the degrees of freedom
// that support both: (y_a + y_b, y'_a + y'_b).
inline double response(const LinkSide& a, const LinkSide& b, int row, int other) {
  if (!of_one_tree(a, b)) return response(a, row, other) + response(b, row, other);
  const double *y_a = a.row(row), *x_a = a.row(other), *y_b = b.row(row), *x_b = b.row(other);
  std::uint32_t i = 0, j = 0, d_a = a.first, d_b = b.first;
  double sum = 0.0;
  for (; a.depth - i > b.depth - j; d_a = a.next[d_a], ++i) sum += y_a[i] * x_a[i];
  for (; b.depth - j > a.depth - i; d_b = b.next[d_b], ++j) sum += y_b[j] * x_b[j];
  for (; i < a.depth; d_a = a.next[d_a], d_b = b.next[d_b], ++i, ++j) {
    sum += d_a == d_b ? (y_a[i] + y_b[j]) * (x_a[i] + x_b[j]) : y_a[i] * x_a[i] + y_b[j] * x_b[j];
  }
  return sum;
}

}  // namespace vp::solve
