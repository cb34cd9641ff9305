// Sequential tests of which player is better, on mirrored pairs of games.
//
// A pair gives the first player 0, 1/4, 1/2, 3/4 or 1 of its points: five outcomes ("pentanomial"),
// whose mean s is the expected score. H0: s = s0, H1: s = s1. After N pairs with frequencies p_i
// the generalized log-likelihood ratio is
//   LLR = N sum_i p_i log(p1_i / p0_i),   pk the distribution of mean sk that is nearest to p,
//   pk_i = p_i / (1 + t (a_i - sk)),
//   t the root of sum_i p_i (a_i - sk) / (1 + t (a_i - sk)) = 0.
// The test ends with H1 when LLR >= log((1 - beta) / alpha), with H0 when LLR <= log(beta / (1 -
// alpha)). By Wald's bounds the error probabilities are at most about alpha and beta.
// Sources: Wald 1945 (wald1945), Van den Bergh 2020 (vandenbergh2020), docs/references.bib.
//
// Testing by betting decides whether s lies within a band [1 - c, c], with four hypotheses. Against
// "s >= c" the capital after pairs of scores a is
//   K = prod (1 + l (c - a)),   0 < l < 1 / (1 - c),
// a supermartingale if the hypothesis holds, for any distribution of the scores. By Ville's
// inequality K reaches 1 / alpha with probability at most alpha. So the test can be evaluated after
// every pair and stopped at any time. "s <= c", "s >= 1 - c", "s <= 1 - c" likewise.
// "Within": "s >= c" and "s <= 1 - c" are both rejected, each with alpha (an s outside satisfies
// one of them). "Beyond": "s <= c" or "s >= 1 - c" is rejected, each with alpha / 2. Source:
// Waudby-Smith and Ramdas 2024 (waudbysmith2024).
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

namespace match {

using PairCounts = std::array<std::uint64_t, 5>;

// The usual logistic scale: a difference of 400 Elo means odds of 10 to 1.
double score_of_elo(double elo);
double elo_of_score(double score);  // 0 < score < 1

std::uint64_t pair_count(const PairCounts& pairs);
// Mean fraction of a pair's points; 1/2 without pairs.
double mean_score(const PairCounts& pairs);
// Standard error of the mean, from the variance of the pairs.
double score_error(const PairCounts& pairs);

double log_likelihood_ratio(const PairCounts& pairs, double score0, double score1);

enum class Verdict { open, h0, h1 };

struct SequentialTest {
  double score0 = 0.5, score1 = 0.55;  // 0 < score0 < score1 < 1
  double alpha = 0.05, beta = 0.05;  // error probabilities: H1 although s = s0; H0 although s = s1

  double lower_bound() const;
  double upper_bound() const;
  Verdict verdict(const PairCounts& pairs) const;
};

struct Band {
  double limit = 0.6;   // c: 1/2 < c < 1
  double alpha = 0.05;  // error probability of "within" outside, and of "beyond" inside
};

// Processes the pairs in order.
class BandTest {
 public:
  explicit BandTest(Band band) : band_(band) {}
  void take(std::size_t half_points);  // of a pair, 0 to 4
  Verdict verdict() const;             // h0: within; h1: beyond; final once it is not open

 private:
  Band band_;
  // Logarithm of the capital against s >= c, s <= 1 - c, s <= c, s >= 1 - c.
  std::array<double, 4> capital_{};
  std::array<bool, 4> rejected_{};
  Verdict verdict_ = Verdict::open;
};

}  // namespace match
