#include "profile/tuning_profile.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>

#include <string>

namespace profile {
namespace {

using foosball::kTuningFields;
using foosball::Tuning;
using foosball::TuningField;

// A different number for each value; thirds are not short decimals.
TEST(TuningProfile, ComesBackBitForBit) {
  Tuning tuning;
  double share = 0.0;
  visit_fields(tuning, [&](const TuningField& field, double& value) {
    share += 1.0 / 31.0;
    value = field.min + share * (field.max - field.min);
  });
  const auto again = parse_tuning(format_tuning(tuning), "x.toml");
  ASSERT_TRUE(again) << again.error();
  EXPECT_TRUE(*again == tuning);
}

TEST(TuningProfile, OfTheDefaultsAndAnEmptyOneAreTheDefaults) {
  EXPECT_TRUE(parse_tuning(format_tuning({}), "x.toml").value() == Tuning{});
  EXPECT_TRUE(parse_tuning("", "x.toml").value() == Tuning{});
  EXPECT_EQ(parse_tuning("gravity = 9", "x.toml").value().gravity, 9.0) << "a whole number";
}

TEST(TuningProfile, TakesTheEndsOfEachRangeAndRefusesWhatLiesBeyondWithItsLine) {
  for (const TuningField& field : kTuningFields) {
    const std::string name = field.name;
    for (const double end : {field.min, field.max}) {
      EXPECT_TRUE(parse_tuning(name + " = " + std::to_string(end + 0.0) + "\n", "x.toml") ||
                  end < 1e-3)
          << name;
    }
    for (const std::string bad : {"-1.0", "1e9", "nan", "inf", "true", "\"9\"", "[1]"}) {
      const auto result = parse_tuning("\n# words\n" + name + " = " + bad + "\n", "x.toml");
      ASSERT_FALSE(result) << name << bad;
      EXPECT_EQ(result.error().rfind("x.toml:3: ", 0), 0u) << result.error();
      EXPECT_NE(result.error().find("must be a number from"), std::string::npos);
    }
  }
}

TEST(TuningProfile, NamesFileLineAndCureOfWhatItDoesNotKnow) {
  for (const std::string bad :
       {"gravitas = 9", "[ball]\nmass = 1", "gravity", "gravity = ", "= 1",
        "gravity = 9\ngravity = 9", "\x01", "a = \"", "[[", "gravity = 9 9"}) {
    const auto result = parse_tuning(bad, "mine.toml");
    ASSERT_FALSE(result) << bad;
    EXPECT_EQ(result.error().rfind("mine.toml:", 0), 0u) << result.error();
    EXPECT_NE(result.error().find(';'), std::string::npos) << result.error();
  }
}

TEST(TuningProfile, RefusesFilesThatAreNone) {
  EXPECT_NE(load_tuning("/nowhere/x.toml").error().find("cannot be read"), std::string::npos);
  EXPECT_FALSE(load_tuning("/"));
  EXPECT_FALSE(load_tuning("/dev/zero"));
}

TEST(TuningProfile, IsSavedWholeAndWhatWasNoProfileIsKeptBeside) {
  namespace fs = std::filesystem;
  const fs::path folder = fs::path(testing::TempDir()) / ("profiles" + std::to_string(::getpid()));
  const std::string path = (folder / "new" / "mine.toml").string();
  Tuning tuning;
  tuning.gravity = 9.0;
  ASSERT_TRUE(save_tuning(tuning, path));
  EXPECT_TRUE(load_tuning(path).value() == tuning);
  std::ofstream(path) << "gravity = \"garbage";
  ASSERT_TRUE(save_tuning({}, path));
  EXPECT_TRUE(load_tuning(path).value() == Tuning{});
  EXPECT_TRUE(fs::exists(path + ".bad"));
  EXPECT_FALSE(save_tuning({}, folder.string()));
  EXPECT_FALSE(save_tuning({}, "/proc/nowhere/x.toml"));
  fs::remove_all(folder);
}

}  // namespace
}  // namespace profile
