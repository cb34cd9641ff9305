// How each row of an island answers each: W = J M^-1 J^T, of islands of few rows.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "solve/islands.h"

namespace vp::solve {

inline constexpr std::uint32_t kMaxDenseRows = 128;

// A joint row, or a contact by its first row, and something that it pushes.
struct DenseEnd {
  MovingBodyKey mover;
  std::uint32_t row, contact;
  bool operator==(const DenseEnd&) const = default;
  bool operator<(const DenseEnd& other) const {
    return mover != other.mover ? mover < other.mover : row < other.row;
  }
};

// Kept from instant to instant for its capacity.
struct DenseScratch {
  std::vector<double> matrix;   // of the island at hand
  std::vector<double> answers;  // y of a mover's rows
  std::vector<double> columns;  // the same, turned
  std::vector<double> factor;
  std::vector<std::uint32_t> rows;
  std::vector<DenseEnd> ends;

  // Of articulations with so many degrees of freedom at most.
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

// Into scratch.matrix, lines of in_fours(rows) numbers (fours.h). The island's rows have to be
// prepared: joint rows first, then those of its contacts.
void write_dense_matrix(const StepContext& context, const Islands& islands, const Island& island,
                        DenseScratch& scratch);

}  // namespace vp::solve
