// The matrix product and the elimination of a small island (dense_island.h), compiled for several
// instruction sets. All give the same bits (passes.h).
#pragma once

#include <cstddef>
#include <cstdint>

namespace vphysics_dense {

// Adds the lower half of Y Y^T to W. Y has `count` rows, at most 128, of `size` numbers each. Row i
// of Y is row rows[i] of W; these ascend. Efficient if most entries of Y are zero. columns: scratch
// of size times in_fours(count) numbers.
struct Products {
  const double* Y;
  std::size_t count, size;
  const std::uint32_t* rows;
  double* columns;
  double* W;
  std::size_t stride;  // of W
};
// Solves A x = b. A has n lines of `stride` numbers; those after the n-th are zero. In the first
// `symmetric` lines only the upper triangle is updated. The other lines use partial pivoting. b
// becomes x; A is overwritten.
struct Equations {
  double** A;
  double* b;
  std::size_t n, symmetric, stride;
};
struct Passes {
  void (*add_products)(const Products& products);
  bool (*solve)(const Equations& equations);  // false: a pivot is zero
};

extern const Passes kBaseline;
// Only in libraries built with VP_INSTRUCTION_SETS.
extern const Passes kAvx2, kAvx512;

}  // namespace vphysics_dense

namespace vp::solve {

// The passes for this machine.
const vphysics_dense::Passes& dense_passes();

}  // namespace vp::solve
