// Articulations as the solver sees them.
//
// An articulation is a vector z, the impulses that its joints have been given so far, in the
// coordinates of ImpulseFactor (multibody/impulse_factor.h): there an impulse p along a row adds
// y p to z, and the row's speed grows by (y, z). y is prepared once a solve and has entries for the
// degrees of freedom between the link and the root only. The solver knows nothing else of a tree.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "multibody/impulse_factor.h"

namespace vp::solve {

struct SolverArticulation {
  detail::ImpulseFactor* factor;
  double* velocity;  // z: of the velocities; written by the solver
  double* shift;     // likewise, of the position correction
  bool touched;      // by a contact; prepared
};

// What a contact or a joint row has to do with one articulation: nothing, if depth is 0.
struct LinkSide {
  const double* rows = nullptr;         // y of row 0, of row 1, ...
  const std::uint32_t* next = nullptr;  // of each degree of freedom
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
inline void push(const LinkSide& side, int row, double p, double* z) {
  const double* y = side.row(row);
  for (std::uint32_t k = 0, d = side.first; k < side.depth; ++k, d = side.next[d]) {
    z[d] += y[k] * p;
  }
}
// The speed that a unit impulse along one row gives another: (y, y').
inline double response(const LinkSide& side, int row, int other) {
  const double *y = side.row(row), *x = side.row(other);
  double sum = 0.0;
  for (std::uint32_t k = 0; k < side.depth; ++k) sum += y[k] * x[k];
  return sum;
}

// The same between rows of two links of one articulation, which share what carries both. Degrees of
// freedom farther out have greater numbers, but within one joint, which both rows have as a whole.
inline double response(const LinkSide& a, int row_a, const LinkSide& b, int row_b) {
  const double *y = a.row(row_a), *x = b.row(row_b);
  double sum = 0.0;
  std::uint32_t i = 0, j = 0, d = a.first, e = b.first;
  while (i < a.depth && j < b.depth) {
    const bool a_goes = d >= e, b_goes = e >= d;
    if (a_goes && b_goes) sum += y[i] * x[j];
    if (a_goes) ++i, d = a.next[d];
    if (b_goes) ++j, e = b.next[e];
  }
  return sum;
}

}  // namespace vp::solve
