// Values of a computer player's judgment as text, and their effect.
#include "foosball/judgment.h"

#include <gtest/gtest.h>

#include "foosball/computer_player.h"

namespace foosball {
namespace {

TEST(Judgment, IsTheSameAfterItsChangesAreWrittenAndRead) {
  const Judgment base = judgment_of(5, PlayStyle::gambler);
  Judgment judgment = base;
  double share = 0.0;
  for (const JudgmentField& field : kJudgmentFields) {
    share += 1.0 / 37.0;  // not a short decimal
    judgment.*field.value = field.min + share * (field.max - field.min);
  }
  const auto again = with_changes(base, changes_of(base, judgment));
  ASSERT_TRUE(again) << again.error().message;
  EXPECT_EQ(*again, judgment);
  EXPECT_EQ(changes_of(base, base), "");
  EXPECT_EQ(with_changes(base, "").value(), base);
}

TEST(Judgment, ChangesWhatIsNamedAlone) {
  Judgment expected;
  expected.shot_bar = 0.4;
  expected.hands_goalie = -0.5;
  EXPECT_EQ(with_changes({}, "hands_goalie=-0.5,shot_bar=0.4").value(), expected);
}

TEST(Judgment, RefusesWithASentenceWhatIsNoValueOrOutOfRange) {
  const std::pair<const char*, const char*> cases[] = {
      {"shot", "--list-judgment 5 shows the names"},
      {"bar=1", "--list-judgment 5 shows the names"},
      {"=1", "is no value"},
      {",", "is no value"},
      {"shot_bar", "is no value"},
      {"shot_bar=", "must be a number from 0 to 0.9"},
      {"shot_bar=high", "must be a number"},
      {"shot_bar=nan", "must be a number"},
      {"shot_bar=1e999", "must be a number"},
      {"shot_bar=0.91", "must be a number"},
      {"shot_bar=0.4 ", "must be a number"},
      {"patience=1,patience=1", "patience is given twice"}};
  for (const auto& [text, sentence] : cases) {
    const auto read = with_changes({}, text);
    ASSERT_FALSE(read) << text;
    EXPECT_NE(read.error().message.find(sentence), std::string::npos) << read.error().message;
  }
}

TEST(Judgment, OfEveryLevelAndStyleIsInItsRanges) {
  for (int level = 0; level <= kLevels + 1; ++level) {
    for (int style = 0; style < kPlayStyles; ++style) {
      EXPECT_TRUE(in_range(judgment_of(level, static_cast<PlayStyle>(style))));
    }
  }
}

}  // namespace
}  // namespace foosball
