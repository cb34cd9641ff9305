#include "match/evolution.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>

#include "match/game.h"
#include "plain_math.h"
#include "vphysics/lie.h"

namespace match {
namespace {

// E|N(0, I)| in n dimensions, by the series of Hansen 2016.
double expected_length(double n) {
  return std::sqrt(n) * (1.0 - 1.0 / (4.0 * n) + 1.0 / (21.0 * n * n));
}

double length(const std::vector<double>& v) {
  return std::sqrt(std::inner_product(v.begin(), v.end(), v.begin(), 0.0));
}

// Limits against noise: it must not stop the search, nor make it jump across the whole cube.
constexpr double kMinStep = 0.01, kMaxStep = 0.5;

}  // namespace

std::size_t usual_population(std::size_t coordinates) {
  const double wanted =
      4.0 + 3.0 * plain_log(static_cast<double>(std::max<std::size_t>(1, coordinates)));
  return 2 * static_cast<std::size_t>(std::ceil(0.5 * wanted));
}

EvolutionStrategy::EvolutionStrategy(Point start, double step, std::size_t population,
                                     std::uint64_t seed)
    : size_(start.size()),
      random_(mix_seed(seed)),
      mean_(std::move(start)),
      step_(step),
      variance_(size_, 1.0),
      path_s_(size_, 0.0),
      path_c_(size_, 0.0),
      samples_(population, Point(size_)) {
  const double n = static_cast<double>(size_), half = 0.5 * static_cast<double>(population);
  for (int rank = 1; rank <= half; ++rank) {
    weights_.push_back(plain_log(half + 0.5) - plain_log(rank));
  }
  const double sum = std::accumulate(weights_.begin(), weights_.end(), 0.0);
  double squares = 0.0;
  for (double& w : weights_) {
    w /= sum;
    squares += w * w;
  }
  mu_w_ = 1.0 / squares;
  c_s_ = (mu_w_ + 2.0) / (n + mu_w_ + 5.0);
  d_s_ = 1.0 + c_s_ + 2.0 * std::max(0.0, std::sqrt((mu_w_ - 1.0) / (n + 1.0)) - 1.0);
  c_c_ = (4.0 + mu_w_ / n) / (n + 4.0 + 2.0 * mu_w_ / n);
  const double faster = (n + 2.0) / 3.0;  // learning rates for n instead of n (n + 1) / 2 numbers
  c_1_ = std::min(0.5, faster * 2.0 / ((n + 1.3) * (n + 1.3) + mu_w_));
  c_mu_ = std::min(1.0 - c_1_,
                   faster * 2.0 * (mu_w_ - 2.0 + 1.0 / mu_w_) / ((n + 2.0) * (n + 2.0) + mu_w_));
  c_mu_ = std::clamp(c_mu_, 0.0, 0.5);
  sample();
}

double EvolutionStrategy::normal() {
  const auto uniform = [&] {
    random_ = mix_seed(random_);
    return (static_cast<double>(random_ >> 11) + 0.5) * 0x1p-53;
  };
  const double radius = std::sqrt(-2.0 * plain_log(uniform()));
  return radius * vp::sin_cos(2.0 * std::numbers::pi * uniform()).cos;
}

void EvolutionStrategy::sample() {
  const Point spread = deviations();
  for (Point& x : samples_) {
    for (std::size_t i = 0; i < size_; ++i) {
      x[i] = std::clamp(mean_[i] + spread[i] * normal(), 0.0, 1.0);
    }
  }
}

Point EvolutionStrategy::deviations() const {
  Point spread(size_);
  for (std::size_t i = 0; i < size_; ++i) spread[i] = step_ * std::sqrt(variance_[i]);
  return spread;
}

void EvolutionStrategy::tell(const std::vector<double>& values) {
  std::vector<std::size_t> order(samples_.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::ranges::stable_sort(order, std::greater<>(), [&](std::size_t k) { return values[k]; });

  std::vector<double> y(size_, 0.0), squares(size_, 0.0);
  for (std::size_t rank = 0; rank < weights_.size(); ++rank) {
    const Point& x = samples_[order[rank]];
    for (std::size_t i = 0; i < size_; ++i) {
      const double way = (x[i] - mean_[i]) / step_;
      y[i] += weights_[rank] * way;
      squares[i] += weights_[rank] * way * way;
    }
  }
  for (std::size_t i = 0; i < size_; ++i) {
    mean_[i] += step_ * y[i];
    path_s_[i] = (1.0 - c_s_) * path_s_[i] +
                 std::sqrt(c_s_ * (2.0 - c_s_) * mu_w_) * y[i] / std::sqrt(variance_[i]);
  }
  means_.push_back(mean_);
  const double n = static_cast<double>(size_), told = static_cast<double>(means_.size());
  const double relative = length(path_s_) / expected_length(n);
  // While |p_s| is large, p_c must not increase the variances too.
  const double unbiased =
      relative / std::sqrt(1.0 - plain_exp(std::max(-600.0, 2.0 * told * plain_log(1.0 - c_s_))));
  const double h = unbiased < 1.4 + 2.0 / (n + 1.0) ? 1.0 : 0.0;
  for (std::size_t i = 0; i < size_; ++i) {
    path_c_[i] = (1.0 - c_c_) * path_c_[i] + h * std::sqrt(c_c_ * (2.0 - c_c_) * mu_w_) * y[i];
    const double missing = (1.0 - h) * c_c_ * (2.0 - c_c_) * variance_[i];
    variance_[i] = (1.0 - c_1_ - c_mu_) * variance_[i] +
                   c_1_ * (path_c_[i] * path_c_[i] + missing) + c_mu_ * squares[i];
  }
  step_ = std::clamp(step_ * plain_exp(std::min(600.0, c_s_ / d_s_ * (relative - 1.0))), kMinStep,
                     kMaxStep);
  sample();
}

Point EvolutionStrategy::answer() const {
  const std::size_t from = means_.size() / 2;
  if (means_.empty()) return mean_;
  Point sum(size_, 0.0);
  for (std::size_t g = from; g < means_.size(); ++g) {
    for (std::size_t i = 0; i < size_; ++i) sum[i] += means_[g][i];
  }
  for (double& x : sum) x /= static_cast<double>(means_.size() - from);
  return sum;
}

}  // namespace match
