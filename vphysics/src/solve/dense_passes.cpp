// The passes for one instruction set; compiled once for each, with VP_DENSE_PASSES the table's name
// (CMakeLists.txt).
#include "solve/dense_passes.h"

#include <cmath>

#include "solve/fours.h"

namespace vp::solve {
namespace {

using vphysics_dense::Equations;
using vphysics_dense::Products;

Four load_four(const double* from) {
  Four x;
  std::memcpy(&x, from, sizeof x);
  return x;
}
void store_four(double* to, const Four& x) {
  std::memcpy(to, &x, sizeof x);
}
Four four_of(double x) {
  return Four{x, x, x, x};
}

constexpr std::size_t kMostRows = 128, kMostListed = 64;

// Adds to sums the products of row i with rows 0 to i, over the listed entries.
void add_listed(const Products& p, std::size_t i, const std::uint32_t* listed, std::size_t count,
                double* sums) {
  const double* const y = p.Y + i * p.size;
  const std::size_t width = in_fours(p.count);
  for (std::size_t j = 0; j <= i; j += kFour) {
    Four sum = load_four(sums + j);
    for (std::size_t n = 0; n < count; ++n) {
      const std::size_t k = listed[n];
      sum += four_of(y[k]) * load_four(p.columns + k * width + j);
    }
    store_four(sums + j, sum);
  }
}

void add_sums(const Products& p, std::size_t i, const double* sums) {
  double* const line = p.W + p.rows[i] * p.stride;
  std::size_t j = 0;
  if (p.rows[i] - p.rows[0] == i) {  // rows 0 to i are consecutive in W
    double* const to = line + p.rows[0];
    for (; j + kFour <= i + 1; j += kFour) {
      store_four(to + j, load_four(to + j) + load_four(sums + j));
    }
  }
  for (; j <= i; ++j) line[p.rows[j]] += sums[j];
}

void add_dense_products(const Products& p) {
  const std::size_t width = in_fours(p.count);
  for (std::size_t k = 0; k < p.size; ++k) {
    double* const column = p.columns + k * width;
    for (std::size_t i = 0; i < p.count; ++i) column[i] = p.Y[i * p.size + k];
    for (std::size_t i = p.count; i < width; ++i) column[i] = 0.0;
  }
  std::uint32_t listed[kMostListed];
  double sums[kMostRows];
  for (std::size_t i = 0; i < p.count; ++i) {
    const double* const y = p.Y + i * p.size;
    for (std::size_t j = 0; j <= i; j += kFour) store_four(sums + j, four_of(0.0));
    std::size_t count = 0;
    for (std::size_t k = 0; k < p.size; ++k) {
      if (y[k] == 0.0) continue;
      listed[count++] = static_cast<std::uint32_t>(k);
      if (count < kMostListed) continue;
      add_listed(p, i, listed, count, sums);
      count = 0;
    }
    add_listed(p, i, listed, count, sums);
    add_sums(p, i, sums);
  }
}

void swap_lines(const Equations& e, std::size_t a, std::size_t b) {
  double* const line = e.A[a];
  e.A[a] = e.A[b];
  e.A[b] = line;
  const double x = e.b[a];
  e.b[a] = e.b[b];
  e.b[b] = x;
}

bool solve_equations(const Equations& e) {
  double** const A = e.A;
  const std::size_t n = e.n;
  for (std::size_t k = 0; k < n; ++k) {
    if (k >= e.symmetric) {
      std::size_t best = k;
      for (std::size_t i = k + 1; i < n; ++i) {
        if (std::fabs(A[i][k]) > std::fabs(A[best][k])) best = i;
      }
      swap_lines(e, k, best);
    }
    if (!(std::fabs(A[k][k]) > 0.0)) return false;
    const double inverse = 1.0 / A[k][k];
    for (std::size_t i = k + 1; i < n; ++i) {
      const bool symmetric = i < e.symmetric;
      const double factor = (symmetric ? A[k][i] : A[i][k]) * inverse;
      if (factor == 0.0) continue;
      const std::size_t begin = (symmetric ? i : k) / kFour * kFour;
      add_scaled(A[i] + begin, A[k] + begin, -factor, e.stride - begin);
      e.b[i] -= factor * e.b[k];
    }
  }
  for (std::size_t k = n; k-- > 0;) {
    for (std::size_t j = k + 1; j < n; ++j) e.b[k] -= A[k][j] * e.b[j];
    e.b[k] /= A[k][k];
  }
  return true;
}

}  // namespace
}  // namespace vp::solve

const vphysics_dense::Passes vphysics_dense::VP_DENSE_PASSES = {vp::solve::add_dense_products,
                                                                vp::solve::solve_equations};
