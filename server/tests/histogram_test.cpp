#include "server/histogram.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>
#include <vector>

namespace server {
namespace {

TEST(Histogram, IsEmptyAtFirst) {
  const Histogram h;
  EXPECT_EQ(h.count(), 0u);
  EXPECT_EQ(h.quantile(0.99), 0);
  EXPECT_EQ(h.max(), 0);
}

TEST(Histogram, IsExactBelowOneOctaveOfSteps) {
  Histogram h;
  for (int value = 0; value < 32; ++value) h.record(value);
  EXPECT_EQ(h.quantile(0.5), 15);
  EXPECT_EQ(h.quantile(1.0), 31);
  EXPECT_EQ(h.quantile(0.0), 0);
}

// Against the sorted values: never below the true quantile, at most 1/32 above.
TEST(Histogram, QuantilesAreWithinOneStepOfTheSortedValues) {
  std::mt19937_64 random(7);
  std::lognormal_distribution<double> durations(9.0, 2.5);  // ns: from below 100 to above 10^8
  Histogram h;
  std::vector<std::int64_t> values;
  for (int i = 0; i < 50'000; ++i) {
    values.push_back(static_cast<std::int64_t>(durations(random)));
    h.record(values.back());
  }
  std::sort(values.begin(), values.end());
  for (const double q : {0.001, 0.1, 0.5, 0.9, 0.99, 0.999, 1.0}) {
    const auto rank = static_cast<std::size_t>(std::ceil(q * static_cast<double>(values.size())));
    const std::int64_t truth = values[rank - 1];
    EXPECT_GE(h.quantile(q), truth) << q;
    EXPECT_LE(h.quantile(q), truth + truth / 32) << q;
  }
  EXPECT_EQ(h.max(), values.back());
}

TEST(Histogram, QuantileNeverExceedsTheMaximum) {
  Histogram h;
  h.record(1'000'001);
  EXPECT_EQ(h.quantile(0.5), 1'000'001);
}

TEST(Histogram, TakesWhatIsOutOfRangeAsItsEnds) {
  Histogram h;
  h.record(-5);
  h.record(INT64_MAX);
  EXPECT_EQ(h.count(), 2u);
  EXPECT_EQ(h.quantile(0.5), 0);
  EXPECT_EQ(h.quantile(1.0), (std::int64_t{1} << 40) - 1);
}

TEST(Histogram, MeanIsThatOfTheValues) {
  Histogram h;
  for (const int value : {100, 200, 600}) h.record(value);
  EXPECT_DOUBLE_EQ(h.mean(), 300.0);
}

}  // namespace
}  // namespace server
