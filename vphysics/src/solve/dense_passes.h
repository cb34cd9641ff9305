// The products and the elimination of a small island (dense_island.h), compiled for several
// instruction sets, all to the same bits, as passes.h says.
#pragma once

#include <cstddef>
#include <cstdint>

namespace vphysics_dense {

// `count` rows Y, at most 128, each `size` numbers that begin at a multiple of size: adds Y Y^T to
// what W has in their places, rows[i] and rows[j] being those of i and of j, of which j is no
// larger. columns: a scratch of size times in_fours(count) numbers. Most of a row is zero.
struct Products {
  const double* Y;
  std::size_t count, size;
  const std::uint32_t* rows;
  double* columns;
  double* W;
  std::size_t stride;  // of W
};
// A x = b, n lines of `stride` numbers of which those behind the n-th are zero. Of the first
// `symmetric` lines only what is right of the diagonal is kept up; of the others the largest of
// each column is the pivot. b becomes x; the lines are used up.
struct Equations {
  double** A;
  double* b;
  std::size_t n, symmetric, stride;
};
struct Passes {
  void (*add_products)(const Products& products);
  bool (*solve)(const Equations& equations);  // false: there is no pivot
};

extern const Passes kBaseline;
// Only in libraries built with VP_INSTRUCTION_SETS.
extern const Passes kAvx2, kAvx512;

}  // namespace vphysics_dense

namespace vp::solve {

// Those for this machine.
const vphysics_dense::Passes& dense_passes();

}  // namespace vp::solve
