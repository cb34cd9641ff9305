// The summary against values calculated by hand, and the exports.
#include "results/questionnaire.h"

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "samples.h"

namespace results {
namespace {

Answers sheet(std::array<int, kQuestions> scores, std::int64_t id = 1) {
  return {.id = id, .match = 7, .team = 1, .rods = 0xF0, .scores = scores};
}

TEST(Questionnaire, SummaryIsOfThoseWhoAnswered) {
  const std::vector<Answers> all{sheet({5, 0, 1, 3, 1, 2}), sheet({4, 0, 2, 3, 5, 0}),
                                 sheet({4, 0, 4, 3, 0, 0}), sheet({1, 2, 5, 3, 0, 0})};
  const auto s = summarise(all);
  EXPECT_EQ(s[0].n, 4u);
  EXPECT_DOUBLE_EQ(s[0].median, 4.0);
  EXPECT_DOUBLE_EQ(s[0].mean, 3.5);
  EXPECT_NEAR(s[0].deviation, 1.7320508, 1e-7);  // squares 58 - 4 * 12.25 = 9, / 3
  EXPECT_EQ(s[0].counts, (std::array<std::uint64_t, 5>{1, 0, 0, 2, 1}));
  EXPECT_EQ(s[1].n, 1u);
  EXPECT_DOUBLE_EQ(s[1].median, 2.0);
  EXPECT_DOUBLE_EQ(s[1].deviation, 0.0);
  EXPECT_DOUBLE_EQ(s[2].median, 3.0) << "between 2 and 4";
  EXPECT_DOUBLE_EQ(s[3].deviation, 0.0);
  EXPECT_DOUBLE_EQ(s[4].median, 3.0);
  EXPECT_EQ(summarise({})[0].n, 0u);
}

TEST(Questionnaire, ExportsOneRowASheetWithItsMatch) {
  std::vector<MatchResult> matches{match_between("Ann", "Bob", 5, 3)};
  matches[0].id = 7;
  Answers lost = sheet({1, 1, 1, 1, 1, 1}, 2);
  lost.match = 8;
  const std::vector<Answers> all{sheet({5, 4, 0, 1, 3, 2}), lost};
  EXPECT_EQ(answers_csv(all, matches),
            "sheet,match,finished_at,layout,play_s,team,rods,goals_for,goals_against,fun,intuitive,"
            "responsive,plausible,visible,absorbed\r\n"
            "1,7,2026-11-22T20:00:00Z,tournament,123.5,1,240,3,5,5,4,,1,3,2\r\n"
            "2,8,,,,1,240,,,1,1,1,1,1,1\r\n");
}

TEST(Questionnaire, NobodysAnswersAreNoFigures) {
  const std::string table = answers_table({});
  EXPECT_NE(table.find("0 players answered"), std::string::npos);
  EXPECT_EQ(table.find("nan"), std::string::npos);
  const auto json = nlohmann::json::parse(answers_json({}));
  EXPECT_EQ(json["questions"].size(), static_cast<std::size_t>(kQuestions));
  EXPECT_FALSE(json["questions"][0].contains("mean"));
}

TEST(Questionnaire, TellsTheSameInEachForm) {
  const std::vector<Answers> all{sheet({5, 0, 0, 0, 0, 0}), sheet({2, 0, 0, 0, 0, 0}, 2)};
  const auto json = nlohmann::json::parse(answers_json(all));
  EXPECT_EQ(json["questions"][0]["median"], 3.5);
  EXPECT_EQ(json["questions"][0]["statement"], "Playing was fun.");
  EXPECT_NE(answers_table(all).find("3.5"), std::string::npos);
}

}  // namespace
}  // namespace results
