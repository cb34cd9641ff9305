// The design of the study of tuning values, and the series of one of its points.
#include "match/study.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <set>

namespace match {
namespace {

TEST(Study, VariesValuesThatExistWithinTheirRanges) {
  for (const StudiedValue& studied : studied_values()) {
    const int index = foosball::tuning_index(studied.name);
    ASSERT_GE(index, 0) << studied.name;
    const auto& field = foosball::kTuningFields[static_cast<std::size_t>(index)];
    EXPECT_LT(studied.low, studied.high);
    EXPECT_TRUE(in_range(field, studied.low) && in_range(field, studied.high)) << studied.name;
    const double usual = foosball::Tuning{}.*field.value;
    EXPECT_TRUE(studied.low <= usual && usual <= studied.high)
        << studied.name << ": the default lies outside";
  }
}

TEST(Study, HasTheDefaultsEachValueAloneAndSamplesThatFillTheBox) {
  constexpr std::uint64_t kSamples = 64;
  const auto points = study_points(kSamples);
  const std::size_t values = studied_values().size();
  ASSERT_EQ(points.size(), 1 + 5 * values + kSamples);
  EXPECT_EQ(points[0].tuning, foosball::Tuning{});
  std::set<std::string> names;
  for (const StudyPoint& point : points) {
    EXPECT_TRUE(in_range(point.tuning)) << point.name;
    EXPECT_TRUE(names.insert(point.name).second) << point.name << " twice";
  }
  // In each dimension every quarter has its fraction of the samples.
  for (const StudiedValue& studied : studied_values()) {
    const auto field =
        foosball::kTuningFields[static_cast<std::size_t>(foosball::tuning_index(studied.name))];
    std::array<int, 4> quarters{};
    for (std::size_t i = points.size() - kSamples; i < points.size(); ++i) {
      const double share =
          (points[i].tuning.*field.value - studied.low) / (studied.high - studied.low);
      ++quarters[static_cast<std::size_t>(std::clamp(static_cast<int>(4.0 * share), 0, 3))];
    }
    for (const int count : quarters) EXPECT_NEAR(count, kSamples / 4, 6) << studied.name;
  }
  EXPECT_EQ(study_points(kSamples)[70].tuning, points[70].tuning) << "the same at every run";
}

TEST(Study, VariesTheValuesAboutThoseThatItWasGiven) {
  StudyPlan plan{.matches = 2, .samples = 1};
  plan.tuning.gravity = 14.0;
  plan.tuning.serve_ahead = 0.02;  // not studied
  const auto series = study_series(plan);
  EXPECT_EQ(series[0].tuning, plan.tuning);
  int others = 0;
  for (const SeriesDesc& desc : series) {
    EXPECT_EQ(desc.tuning.serve_ahead, 0.02);
    others += desc.tuning.gravity != 14.0 ? 1 : 0;
  }
  EXPECT_EQ(others, 2 * (5 + 1)) << "its own levels, and the sample";
  EXPECT_NE(study_points(0, plan.tuning)[0].name.find("gravity=14 "), std::string::npos);
}

TEST(Study, PlaysEachPointWithItsValuesInBothLayouts) {
  const StudyPlan plan{.player = "classic:0.9", .max_ticks = 3000, .matches = 2, .samples = 1};
  const auto series = study_series(plan);
  ASSERT_EQ(series.size(), 2 * study_points(1).size());
  EXPECT_NE(series[0].text(), series[2].text()) << "a checkpoint tells them apart";
  const auto hash = [&](std::size_t i) {
    return play_game(Series(series[i]).game(0)).result.state_hash;
  };
  EXPECT_NE(hash(0), hash(1)) << "layouts";
  EXPECT_NE(hash(0), hash(2)) << "gravity";
  EXPECT_EQ(hash(2), hash(2));
}

TEST(Study, PlaysWithTheCharactersThatItWasGiven) {
  StudyPlan plan{.matches = 2, .samples = 0};
  plan.character_list = {foosball::built_in_characters()[2]};
  for (const SeriesDesc& desc : study_series(plan)) {
    EXPECT_EQ(desc.character_list, plan.character_list);
    EXPECT_EQ(Series(desc).game(0).characters, (std::array{0, 0}));
  }
}

}  // namespace
}  // namespace match
