// Sequential tests of who is better, on mirrored pairs of games.
//
// A pair gives the first player 0, 1/4, 1/2, 3/4 or 1 of its points: five outcomes ("pentanomial"),
// whose mean s is the expected score. H0: s = s0, H1: s = s1. After N pairs with frequencies p_i
// the generalized log-likelihood ratio is
//   LLR = N sum_i p_i log(p1_i / p0_i),   pk the distribution of mean sk that is nearest to p,
//   pk_i = p_i / (1 + t (a_i - sk)),      t the root of sum_i p_i (a_i - sk) / (1 + t (a_i - sk)) =
//   0.
// The test ends with H1 when LLR >= log((1 - beta) / alpha), with H0 when LLR <= log(beta / (1 -
// alpha)): Wald's bounds, so that the errors are at most about alpha and beta.
// Sources: Wald 1945 (wald1945), Van den Bergh 2020 (vandenbergh2020), docs/references.bib.
#pragma once

#include <array>
#include <cstdint>

namespace match {

using PairCounts = std::array<std::uint64_t, 5>;

// The usual logistic scale: 400 Elo are odds of 10 to 1.
double score_of_elo(double elo);
double elo_of_score(double score);  // 0 < score < 1

std::uint64_t pair_count(const PairCounts& pairs);
// Mean of a pair's share of points; 1/2 without pairs.
double mean_score(const PairCounts& pairs);
// Standard error of the mean: from the pairs' own variance.
double score_error(const PairCounts& pairs);

double log_likelihood_ratio(const PairCounts& pairs, double score0, double score1);

enum class Verdict { open, h0, h1 };

struct SequentialTest {
  double score0 = 0.5, score1 = 0.55;  // 0 < score0 < score1 < 1
  double alpha = 0.05, beta = 0.05;    // of deciding for H1 though s = s0; for H0 though s = s1

  double lower_bound() const;
  double upper_bound() const;
  Verdict verdict(const PairCounts& pairs) const;
};

}  // namespace match
