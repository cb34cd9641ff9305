#include "match/sequential.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "plain_math.h"

namespace match {
namespace {

using Frequencies = std::array<double, 5>;

double points(std::size_t outcome) {
  return 0.25 * static_cast<double>(outcome);
}

// The distribution of mean s nearest to p, as factors p_i / pk_i = 1 + t (a_i - s). The sum
// decreases with t between its two poles, so bisection finds its root t.
double tilt(const Frequencies& p, double s) {
  double low = -1.0 / (1.0 - s), high = 1.0 / s;
  for (int i = 0; i < 200; ++i) {
    const double t = 0.5 * (low + high);
    double sum = 0.0;
    for (std::size_t k = 0; k < p.size(); ++k) {
      const double a = points(k) - s;
      sum += p[k] * a / (1.0 + t * a);
    }
    (sum > 0.0 ? low : high) = t;
  }
  return 0.5 * (low + high);
}

}  // namespace

double score_of_elo(double elo) {
  return 1.0 / (1.0 + plain_exp(-elo / 400.0 * std::numbers::ln10));
}

double elo_of_score(double score) {
  return -400.0 * std::log10(1.0 / score - 1.0);
}

std::uint64_t pair_count(const PairCounts& pairs) {
  std::uint64_t sum = 0;
  for (const std::uint64_t count : pairs) sum += count;
  return sum;
}

double mean_score(const PairCounts& pairs) {
  const std::uint64_t n = pair_count(pairs);
  if (n == 0) return 0.5;
  double sum = 0.0;
  for (std::size_t i = 0; i < pairs.size(); ++i) sum += points(i) * static_cast<double>(pairs[i]);
  return sum / static_cast<double>(n);
}

double score_error(const PairCounts& pairs) {
  const double n = static_cast<double>(pair_count(pairs));
  if (n < 2.0) return 0.5;
  const double mean = mean_score(pairs);
  double sum = 0.0;
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    sum += static_cast<double>(pairs[i]) * (points(i) - mean) * (points(i) - mean);
  }
  return std::sqrt(sum / (n - 1.0) / n);
}

double log_likelihood_ratio(const PairCounts& pairs, double score0, double score1) {
  const double n = static_cast<double>(pair_count(pairs));
  if (n == 0.0) return 0.0;
  // Unseen outcomes count as 0.001 of one: otherwise a distribution with the other mean may not
  // exist.
  Frequencies p{};
  double sum = 0.0;
  for (std::size_t i = 0; i < p.size(); ++i) {
    p[i] = std::max(static_cast<double>(pairs[i]), 1e-3);
    sum += p[i];
  }
  for (double& frequency : p) frequency /= sum;
  const double t0 = tilt(p, score0), t1 = tilt(p, score1);
  double ratio = 0.0;
  for (std::size_t i = 0; i < p.size(); ++i) {
    const double f0 = 1.0 + t0 * (points(i) - score0), f1 = 1.0 + t1 * (points(i) - score1);
    ratio += p[i] * plain_log(f0 / f1);
  }
  return sum * ratio;
}

double SequentialTest::lower_bound() const {
  return plain_log(beta / (1.0 - alpha));
}

double SequentialTest::upper_bound() const {
  return plain_log((1.0 - beta) / alpha);
}

Verdict SequentialTest::verdict(const PairCounts& pairs) const {
  const double ratio = log_likelihood_ratio(pairs, score0, score1);
  return ratio >= upper_bound()   ? Verdict::h1
         : ratio <= lower_bound() ? Verdict::h0
                                  : Verdict::open;
}

void BandTest::take(std::size_t half_points) {
  // The fraction of the capital that is bet. Its growth is largest for a mean 0.1 away from the
  // hypothesis (0.1 over the sum of the pairs' variance of 1/8 and 0.1 squared), and still positive
  // at 0.05.
  constexpr double kStake = 0.7;
  const double s = points(half_points), c = band_.limit;
  const std::array<double, 4> gain{c - s, s - (1.0 - c), s - c, (1.0 - c) - s};
  for (std::size_t i = 0; i < gain.size(); ++i) {
    capital_[i] += plain_log(1.0 + kStake * gain[i]);
    rejected_[i] = rejected_[i] || capital_[i] >= plain_log((i < 2 ? 1.0 : 2.0) / band_.alpha);
  }
  if (verdict_ != Verdict::open) return;
  verdict_ = rejected_[2] || rejected_[3]   ? Verdict::h1
             : rejected_[0] && rejected_[1] ? Verdict::h0
                                            : Verdict::open;
}

Verdict BandTest::verdict() const {
  return verdict_;
}

}  // namespace match
