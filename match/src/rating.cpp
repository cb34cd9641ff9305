#include "match/rating.h"

#include <cmath>

namespace match {
namespace {

constexpr double kEloPerNat = 173.71779276130073;  // 400 / ln 10

struct Games {
  std::size_t first, second;
  double n, points;  // number of games; points of the first player
};

std::vector<Games> games_of(const std::vector<Encounter>& encounters) {
  std::vector<Games> all;
  for (const Encounter& e : encounters) {
    const double pairs = static_cast<double>(pair_count(e.pairs));
    const double n = 2.0 * pairs + 1.0;
    all.push_back({e.first, e.second, n, 2.0 * pairs * mean_score(e.pairs) + 0.5});
  }
  return all;
}

double logistic(double x) {
  return 1.0 / (1.0 + std::exp(-x));
}

// Solves A x = b by Gaussian elimination with pivoting; A is row-major, n x n.
std::vector<double> solve(std::vector<double> A, std::vector<double> b) {
  const std::size_t n = b.size();
  for (std::size_t k = 0; k < n; ++k) {
    std::size_t pivot = k;
    for (std::size_t i = k + 1; i < n; ++i) {
      if (std::fabs(A[i * n + k]) > std::fabs(A[pivot * n + k])) pivot = i;
    }
    for (std::size_t j = 0; j < n; ++j) std::swap(A[k * n + j], A[pivot * n + j]);
    std::swap(b[k], b[pivot]);
    for (std::size_t i = k + 1; i < n; ++i) {
      const double factor = A[i * n + k] / A[k * n + k];
      for (std::size_t j = k; j < n; ++j) A[i * n + j] -= factor * A[k * n + j];
      b[i] -= factor * b[k];
    }
  }
  for (std::size_t k = n; k-- > 0;) {
    for (std::size_t j = k + 1; j < n; ++j) b[k] -= A[k * n + j] * b[j];
    b[k] /= A[k * n + k];
  }
  return b;
}

// Negative Hessian of the log-likelihood. The added 1/n everywhere fixes the mean.
std::vector<double> information(std::size_t n, const std::vector<Games>& games,
                                const std::vector<double>& r) {
  std::vector<double> H(n * n, 1.0 / static_cast<double>(n));
  for (const Games& g : games) {
    const double p = logistic(r[g.first] - r[g.second]);
    const double weight = g.n * p * (1.0 - p);
    H[g.first * n + g.first] += weight;
    H[g.second * n + g.second] += weight;
    H[g.first * n + g.second] -= weight;
    H[g.second * n + g.first] -= weight;
  }
  return H;
}

}  // namespace

// Newton's method; the log-likelihood is concave.
std::vector<Rating> rate(std::size_t n, const std::vector<Encounter>& encounters) {
  const std::vector<Games> games = games_of(encounters);
  std::vector<double> r(n, 0.0);
  for (int iteration = 0; iteration < 100; ++iteration) {
    std::vector<double> gradient(n, 0.0);
    for (const Games& g : games) {
      const double surplus = g.points - g.n * logistic(r[g.first] - r[g.second]);
      gradient[g.first] += surplus;
      gradient[g.second] -= surplus;
    }
    const std::vector<double> change = solve(information(n, games, r), gradient);
    double largest = 0.0;
    for (std::size_t i = 0; i < n; ++i) {
      r[i] += std::fmin(std::fmax(change[i], -2.0), 2.0);
      largest = std::fmax(largest, std::fabs(change[i]));
    }
    if (largest < 1e-12) break;
  }
  std::vector<Rating> ratings(n);
  double mean = 0.0;
  for (const double x : r) mean += x / static_cast<double>(n);
  const std::vector<double> H = information(n, games, r);
  for (std::size_t i = 0; i < n; ++i) {
    std::vector<double> unit(n, 0.0);
    unit[i] = 1.0;
    const double variance = solve(H, unit)[i] - 1.0 / static_cast<double>(n);
    ratings[i] = {kEloPerNat * (r[i] - mean), kEloPerNat * std::sqrt(std::fmax(variance, 0.0))};
  }
  return ratings;
}

}  // namespace match
