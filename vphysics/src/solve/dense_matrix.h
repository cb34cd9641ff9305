// The dense matrix W = J M^-1 J^T of an island of few rows.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "solve/islands.h"

namespace vp::solve {

inline constexpr std::uint32_t kMaxDenseRows = 128;

// A joint row, or a contact by its first row, and a body or articulation that its impulses move.
struct DenseEnd {
  MovingBodyKey mover;
  std::uint32_t row, contact;
  bool operator==(const DenseEnd&) const = default;
  bool operator<(const DenseEnd& other) const {
    return mover != other.mover ? mover < other.mover : row < other.row;
  }
};

// Scratch memory; keeps its capacity between instants.
struct DenseScratch {
  std::vector<double> matrix;   // of the current island
  std::vector<double> answers;  // y of the rows of one body or articulation
  std::vector<double> columns;  // the same, transposed
  std::vector<double> factor;
  std::vector<std::uint32_t> rows;
  std::vector<DenseEnd> ends;

  // dofs: the maximum number of degrees of freedom of an articulation.
  void reserve(std::size_t dofs) {
    constexpr std::size_t kRows = kMaxDenseRows;
    matrix.reserve(kRows * kRows);
    factor.reserve(kRows * kRows);
    answers.reserve(kRows * std::max<std::size_t>(8, dofs + 3));
    columns.reserve(answers.capacity());
    rows.reserve(kMaxDenseRows);
    ends.reserve(2 * kMaxDenseRows);
  }
};

// Writes W into scratch.matrix, in lines of in_fours(rows) numbers (fours.h). Precondition: the
// island's rows are prepared. Joint rows come first, then the rows of its contacts.
void write_dense_matrix(const StepContext& context, const Islands& islands, const Island& island,
                        DenseScratch& scratch);

}  // namespace vp::solve
