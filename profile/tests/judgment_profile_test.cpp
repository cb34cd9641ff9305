#include "profile/judgment_profile.h"

#include <gtest/gtest.h>

namespace profile {
namespace {

using foosball::Judgment;
using foosball::JudgmentField;
using foosball::kJudgmentFields;

TEST(JudgmentProfile, ComesBackBitForBit) {
  Judgment judgment;
  double share = 0.0;
  for (const JudgmentField& field : kJudgmentFields) {
    share += 1.0 / 37.0;
    judgment.*field.value = field.min + share * (field.max - field.min);
  }
  const auto again = parse_judgment(format_judgment(judgment, {}), "x.toml", {});
  ASSERT_TRUE(again) << again.error();
  EXPECT_EQ(*again, judgment);
}

TEST(JudgmentProfile, LeavesWhatItDoesNotNameAsThePlayerHasIt) {
  Judgment base;
  base.patience = 1.25;
  EXPECT_EQ(parse_judgment("", "x.toml", base).value(), base);
  Judgment expected = base;
  expected.shot_bar = 0.4;
  EXPECT_EQ(parse_judgment("shot_bar = 0.4\n", "x.toml", base).value(), expected);
}

TEST(JudgmentProfile, NamesFileLineAndCureOfWhatIsWrong) {
  const std::pair<const char*, const char*> cases[] = {
      {"\n\nshot_bar = 0.91\n", "x.toml:3: shot_bar must be a number from 0 to 0.9"},
      {"shot_bar = true", "x.toml:1: shot_bar must be a number"},
      {"# words\npatience = nan", "x.toml:2: patience must be a number from 0.1 to 3 s"},
      {"\nbar = 1",
       "x.toml:2: no value of judgment is named bar; space-foosball-match "
       "--list-judgment 5 shows their names"},
      {"shot_bar 1", "x.toml:1: not TOML"},
      {"shot_bar = 0.1\nshot_bar = 0.2", "x.toml:2: not TOML"}};
  for (const auto& [text, sentence] : cases) {
    const auto read = parse_judgment(text, "x.toml", {});
    ASSERT_FALSE(read) << text;
    EXPECT_EQ(read.error().rfind(sentence, 0), 0u) << read.error();
  }
  EXPECT_FALSE(load_judgment("/nowhere/x.toml", {}));
  EXPECT_FALSE(load_judgment("/dev/zero", {}));
}

}  // namespace
}  // namespace profile
