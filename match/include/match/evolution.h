// Maximizes a noisy and costly function on the unit cube: an evolution strategy with weighted
// recombination, cumulative step-size adaptation and a diagonal covariance matrix (sep-CMA-ES).
// With n coordinates x_i, standard deviations sigma d_i, weights w_1 > .. > w_mu of the best mu of
// lambda samples and mu_w = 1 / sum w^2, a generation computes
//   x = m + sigma D z,  z ~ N(0, I)                  samples, clamped to the cube
//   y = sum w (x - m) / sigma,  m += sigma y         mean of the best
//   p_s = (1 - c_s) p_s + sqrt(c_s (2 - c_s) mu_w) D^-1 y
//   sigma *= exp(c_s / d_s (|p_s| / E|N(0, I)| - 1))
//   p_c = (1 - c_c) p_c + h sqrt(c_c (2 - c_c) mu_w) y
//   D^2 = (1 - c_1 - c_mu) D^2 + c_1 p_c^2 + c_mu sum w ((x - m) / sigma)^2
// Sources: Hansen 2016 (hansen2016) for the constants, Ros and Hansen 2008 (ros2008) for c_1 and
// c_mu of a diagonal matrix, docs/references.bib.
//
// The answer is the average of the mean m over the later half of the generations. It has less noise
// than the best sample, which owes its value partly to chance.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

namespace match {

using Point = std::vector<double>;  // coordinates from 0 to 1

class EvolutionStrategy {
 public:
  // The samples are the same on every machine (src/plain_math.h), so that a search can continue on
  // another one. The same arguments and the same values given to tell() produce the same samples.
  // Preconditions: at least one coordinate, 0 < step <= 1, population >= 4.
  EvolutionStrategy(Point start, double step, std::size_t population, std::uint64_t seed);

  // The samples of the current generation; unchanged until tell().
  const std::vector<Point>& samples() const { return samples_; }
  // Supplies the samples' values, in their order; larger is better. Starts the next generation.
  void tell(const std::vector<double>& values);

  std::size_t generation() const { return means_.size(); }  // number completed by tell()
  const Point& mean() const { return mean_; }
  double step() const { return step_; }
  Point deviations() const;  // of the next samples, per coordinate
  Point answer() const;

 private:
  void sample();
  double normal();

  std::size_t size_;
  std::uint64_t random_;
  Point mean_;
  double step_;
  std::vector<double> weights_;
  double mu_w_ = 1.0, c_s_ = 0.0, d_s_ = 0.0, c_c_ = 0.0, c_1_ = 0.0, c_mu_ = 0.0;
  std::vector<double> variance_, path_s_, path_c_;  // D^2
  std::vector<Point> samples_, means_;
};

// Default population for this number of coordinates: 4 + 3 ln n, even.
std::size_t usual_population(std::size_t coordinates);

}  // namespace match
