// The sequential test and the ratings: closed forms, and simulated players of known strength.
#include "match/sequential.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>

#include "match/game.h"
#include "match/rating.h"

namespace match {
namespace {

// Numbers in [0, 1), identical on all platforms.
class Uniform {
 public:
  explicit Uniform(std::uint64_t seed) : state_(seed) {}
  double operator()() { return static_cast<double>(mix_seed(state_++) >> 11) * 0x1p-53; }

 private:
  std::uint64_t state_;
};

TEST(Elo, OfOddsTenToOneIs400) {
  EXPECT_NEAR(score_of_elo(400.0), 10.0 / 11.0, 1e-15);
  EXPECT_NEAR(elo_of_score(0.65), 107.54, 0.01);
  for (const double elo : {-300.0, 0.0, 12.5})
    EXPECT_NEAR(elo_of_score(score_of_elo(elo)), elo, 1e-9);
}

TEST(LogLikelihoodRatio, OfPairsThatAreAllWonOrLostIsThatOfCoins) {
  // Only 0 and 2 points: the distribution with a given mean is unique, log (s1 / s0) per win.
  const PairCounts pairs{400, 0, 0, 0, 600};
  const double expected = 600 * std::log(0.6 / 0.5) + 400 * std::log(0.4 / 0.5);
  EXPECT_NEAR(log_likelihood_ratio(pairs, 0.5, 0.6), expected, 0.02);
}

TEST(LogLikelihoodRatio, IsAntisymmetricInTheHypothesesAndUnderMirroring) {
  const PairCounts pairs{12, 60, 130, 75, 23}, mirrored{23, 75, 130, 60, 12};
  const double ratio = log_likelihood_ratio(pairs, 0.48, 0.53);
  EXPECT_NEAR(log_likelihood_ratio(pairs, 0.53, 0.48), -ratio, 1e-9);
  EXPECT_NEAR(log_likelihood_ratio(mirrored, 0.52, 0.47), ratio, 1e-9);
  EXPECT_EQ(log_likelihood_ratio({}, 0.5, 0.6), 0.0);
}

TEST(LogLikelihoodRatio, NearsTheNormalApproximationForCloseHypotheses) {
  // Van den Bergh 2020: LLR ~ N (s1 - s0) (2 s - s0 - s1) / (2 var).
  const PairCounts pairs{1023, 9643, 21146, 9750, 970};
  const double n = static_cast<double>(pair_count(pairs)), s = mean_score(pairs);
  const double variance = std::pow(score_error(pairs), 2) * n;
  const double s0 = score_of_elo(-0.5), s1 = score_of_elo(1.5);
  const double expected = n * (s1 - s0) * (2 * s - s0 - s1) / (2 * variance);
  EXPECT_NEAR(log_likelihood_ratio(pairs, s0, s1), expected, 0.01 * std::fabs(expected) + 0.005);
}

// As published by Fishtest for Stockfish's pull requests 2950, 3098 and 3209 (2020), with bounds in
// logistic Elo.
TEST(LogLikelihoodRatio, IsThatOfPublishedTests) {
  struct Published {
    PairCounts pairs;
    double elo0, elo1, ratio;
  };
  const Published published[] = {{{133, 1751, 5094, 1849, 165}, -0.50, 1.50, 2.94},
                                 {{149, 4748, 32785, 5063, 159}, 0.25, 1.75, 2.95},
                                 {{491, 7345, 29693, 7670, 465}, -0.25, 1.25, 2.96},
                                 {{53, 2220, 21459, 2445, 47}, 0.25, 1.25, 2.97},
                                 {{253, 4282, 17604, 4431, 286}, -0.25, 1.25, 2.94},
                                 {{58, 3302, 33130, 3518, 84}, 0.25, 1.25, 2.97}};
  for (const Published& p : published) {
    EXPECT_NEAR(log_likelihood_ratio(p.pairs, score_of_elo(p.elo0), score_of_elo(p.elo1)), p.ratio,
                0.005);
  }
}

TEST(SequentialTest, HasWaldsBounds) {
  const SequentialTest test{0.5, 0.55, 0.05, 0.05};
  EXPECT_NEAR(test.upper_bound(), 2.944439, 1e-6);
  EXPECT_NEAR(test.lower_bound(), -2.944439, 1e-6);
  EXPECT_EQ(test.verdict({}), Verdict::open);
  EXPECT_EQ(test.verdict({0, 0, 0, 0, 40}), Verdict::h1);
  EXPECT_EQ(test.verdict({40, 0, 0, 0, 0}), Verdict::h0);
}

// Fraction of 1000 runs of pairs of independent games in which the test decides for H1.
double share_of_h1(const SequentialTest& test, double win, double draw, double& mean_pairs) {
  Uniform uniform(7);
  int h1 = 0;
  std::uint64_t pairs_played = 0;
  constexpr int kRuns = 1000;
  for (int run = 0; run < kRuns; ++run) {
    PairCounts pairs{};
    while (true) {
      std::size_t points = 0;
      for (int game = 0; game < 2; ++game) {
        const double u = uniform();
        points += u < win ? 2 : u < win + draw ? 1 : 0;
      }
      ++pairs[points];
      ++pairs_played;
      if (pairs_played % 4 != 0) continue;
      const Verdict verdict = test.verdict(pairs);
      if (verdict == Verdict::open) continue;
      h1 += verdict == Verdict::h1 ? 1 : 0;
      break;
    }
  }
  mean_pairs = static_cast<double>(pairs_played) / kRuns;
  return static_cast<double>(h1) / kRuns;
}

TEST(SequentialTest, ErrsAboutAsOftenAsItWasTold) {
  const SequentialTest test{0.5, 0.6, 0.05, 0.05};
  for (const double draw : {0.0, 0.2}) {
    double pairs0 = 0.0, pairs1 = 0.0;
    const double wrong_h1 = share_of_h1(test, 0.5 - 0.5 * draw, draw, pairs0);
    const double wrong_h0 = 1.0 - share_of_h1(test, 0.6 - 0.5 * draw, draw, pairs1);
    std::printf("draws %.1f: wrong for H1 %.3f after %.0f pairs, for H0 %.3f after %.0f\n", draw,
                wrong_h1, pairs0, wrong_h0, pairs1);
    // 0.05 plus 3 standard deviations of 1000 runs, 0.021.
    EXPECT_LT(wrong_h1, 0.071);
    EXPECT_LT(wrong_h0, 0.071);
    EXPECT_GT(wrong_h1 + wrong_h0, 0.02);
  }
}

// Pairs of independent games with this mean score, until the band's test decides or gives up.
struct BandRuns {
  double within = 0.0, beyond = 0.0;  // fractions of the runs
  double matches = 0.0;               // mean per run
};
BandRuns band_runs(double score, double draw, int runs = 1000, int max_pairs = 400) {
  Uniform uniform(static_cast<std::uint64_t>(1e6 * score + 1e3 * draw));
  BandRuns result;
  for (int run = 0; run < runs; ++run) {
    BandTest test({0.6, 0.05});
    int pairs = 0;
    while (pairs < max_pairs && test.verdict() == Verdict::open) {
      std::size_t half_points = 0;
      for (int game = 0; game < 2; ++game) {
        const double u = uniform(), win = score - 0.5 * draw;
        half_points += u < win ? 2 : u < win + draw ? 1 : 0;
      }
      test.take(half_points);
      ++pairs;
    }
    result.within += test.verdict() == Verdict::h0 ? 1.0 / runs : 0.0;
    result.beyond += test.verdict() == Verdict::h1 ? 1.0 / runs : 0.0;
    result.matches += 2.0 * pairs / runs;
  }
  return result;
}

TEST(BandTest, ErrsAtTheEdgesOfTheBandAsOftenAsItWasToldAtMost) {
  // 0.05 plus 2 standard deviations of 1000 runs, 0.014. At 0.6 both verdicts are errors: of a
  // score just outside, and of one just inside.
  for (const double edge : {0.4, 0.6}) {
    for (const double draw : {0.0, 0.2}) {
      const BandRuns runs = band_runs(edge, draw);
      std::printf("score %.2f, draws %.1f: within %.3f, beyond %.3f, %.0f matches\n", edge, draw,
                  runs.within, runs.beyond, runs.matches);
      EXPECT_LT(runs.within, 0.064);
      EXPECT_LT(runs.beyond, 0.064);
      EXPECT_GT(runs.within + runs.beyond, 0.01) << "bounds that are never reached decide nothing";
    }
  }
  EXPECT_LT(band_runs(0.65, 0.0).within, 0.01);
  EXPECT_LT(band_runs(0.35, 0.0).within, 0.01);
  for (const double inside : {0.45, 0.5, 0.55}) EXPECT_LT(band_runs(inside, 0.0).beyond, 0.01);
}

TEST(BandTest, DecidesForWhatIsClear) {
  struct Case {
    double score;
    bool beyond;
    double matches;  // upper bound per run; measured 236, 194, 66
  };
  for (const Case& c : {Case{0.5, false, 260}, Case{0.3, true, 210}, Case{0.8, true, 80}}) {
    const BandRuns runs = band_runs(c.score, 0.0);
    std::printf("score %.2f: within %.3f, beyond %.3f, %.0f matches\n", c.score, runs.within,
                runs.beyond, runs.matches);
    EXPECT_GT(c.beyond ? runs.beyond : runs.within, 0.98);
    EXPECT_LT(runs.matches, c.matches);
  }
}

TEST(BandTest, TreatsBothSidesAlikeAndKeepsItsVerdict) {
  BandTest one({0.6, 0.05}), other({0.6, 0.05});
  Uniform uniform(3);
  Verdict kept = Verdict::open;
  for (int pair = 0; pair < 500; ++pair) {
    const auto half_points = static_cast<std::size_t>(5.0 * uniform());
    one.take(half_points);
    other.take(4 - half_points);
    ASSERT_EQ(one.verdict(), other.verdict());
    ASSERT_TRUE(kept == Verdict::open || one.verdict() == kept);
    kept = one.verdict();
  }
  EXPECT_EQ(kept, Verdict::h0);
  for (int pair = 0; pair < 500; ++pair) one.take(4);
  EXPECT_EQ(one.verdict(), Verdict::h0);
}

TEST(Rating, OfTwoPlayersIsTheEloOfTheirScore) {
  const PairCounts pairs{100, 200, 300, 400, 1000};
  const auto ratings = rate(2, {{0, 1, pairs}});
  EXPECT_NEAR(ratings[0].elo - ratings[1].elo, elo_of_score(mean_score(pairs)), 0.1);
  EXPECT_NEAR(ratings[0].elo + ratings[1].elo, 0.0, 1e-9);
}

TEST(Rating, OfPlayersWhoWonAllTheirGamesIsFinite) {
  const auto ratings = rate(3, {{0, 1, {0, 0, 0, 0, 10}}, {1, 2, {0, 0, 0, 0, 10}}});
  EXPECT_GT(ratings[0].elo, ratings[1].elo + 100.0);
  EXPECT_GT(ratings[1].elo, ratings[2].elo + 100.0);
  EXPECT_LT(ratings[0].elo, 3000.0);
}

TEST(Rating, RecoversKnownStrengthsWithinItsErrorBars) {
  const std::vector<double> truth{-150.0, -40.0, 30.0, 160.0};
  int inside = 0, all = 0;
  for (std::uint64_t seed = 0; seed < 50; ++seed) {
    Uniform uniform(1000 * seed);
    std::vector<Encounter> encounters;
    for (std::size_t i = 0; i < truth.size(); ++i) {
      for (std::size_t k = i + 1; k < truth.size(); ++k) {
        Encounter e{i, k, {}};
        const double p = score_of_elo(truth[i] - truth[k]);
        for (int pair = 0; pair < 100; ++pair) {
          ++e.pairs[(uniform() < p ? 2u : 0u) + (uniform() < p ? 2u : 0u)];
        }
        encounters.push_back(e);
      }
    }
    const auto ratings = rate(truth.size(), encounters);
    for (std::size_t i = 0; i < truth.size(); ++i) {
      inside += std::fabs(ratings[i].elo - truth[i]) < 1.96 * ratings[i].error ? 1 : 0;
      ++all;
    }
  }
  std::printf("%d of %d within the 95 %% bars\n", inside, all);
  EXPECT_GE(inside, all * 88 / 100);
  EXPECT_LT(inside, all);
}

}  // namespace
}  // namespace match
