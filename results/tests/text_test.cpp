#include "results/text.h"

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "samples.h"

namespace results {
namespace {

std::vector<MatchResult> awkward() {
  MatchResult match = match_between("Ann, \"the wall\"", "=1+1", 5, 3);
  match.teams[1].players.push_back({"bad \xff utf-8", "person"});
  match.teams[1].statistics.reset();
  return {match};
}

TEST(Text, CsvQuotesWhatWouldBreakItAndMakesNoFormulas) {
  const std::string csv = matches_csv(awkward());
  EXPECT_NE(csv.find("\"Ann, \"\"the wall\"\"\""), std::string::npos) << csv;
  EXPECT_NE(csv.find(",'=1+1;"), std::string::npos) << csv;
  EXPECT_EQ(csv.find(",=1+1"), std::string::npos) << csv;
  EXPECT_NE(csv.find(",18446744073709551615,"), std::string::npos) << csv;
  // The same number of columns in each line, without the two quoted commas.
  const auto commas = [](const std::string& line) {
    long count = 0;
    bool quoted = false;
    for (const char c : line) {
      if (c == '"') quoted = !quoted;
      count += c == ',' && !quoted;
    }
    return count;
  };
  const auto end = csv.find("\r\n");
  EXPECT_EQ(commas(csv.substr(0, end)), commas(csv.substr(end)));
}

TEST(Text, JsonIsReadBack) {
  const auto json = nlohmann::json::parse(matches_json(awkward()));
  ASSERT_EQ(json.size(), 1u);
  EXPECT_EQ(json[0]["seed"], "18446744073709551615");
  EXPECT_EQ(json[0]["teams"][0]["players"][0]["name"], "Ann, \"the wall\"");
  EXPECT_EQ(json[0]["teams"][0]["shots"], 7);
  EXPECT_FALSE(json[0]["teams"][1].contains("shots"));
  EXPECT_EQ(nlohmann::json::parse(matches_json({})), nlohmann::json::array());
  const auto table = nlohmann::json::parse(standings_json(standings(awkward())));
  EXPECT_EQ(table[0]["player"], "Ann, \"the wall\"");
  EXPECT_NEAR(table[0]["rating"].get<double>(), 1516.0, 1e-9);
}

TEST(Text, SaysWhoPlayedOnlyAPartOfAMatch) {
  std::vector<MatchResult> matches{match_between("Ann", "Bob", 5, 3)};
  matches[0].teams[0].players = {{"Ann", "person", 0.62}, {"computer 2", "computer", 0.38}};
  matches[0].teams[1].players[0].left = true;
  const std::string table = matches_table(matches), csv = matches_csv(matches);
  EXPECT_NE(table.find("Ann (62%), computer 2 "), std::string::npos) << table;
  EXPECT_NE(table.find("Bob (100%, left)"), std::string::npos) << table;
  EXPECT_NE(csv.find(",Ann; computer 2,"), std::string::npos) << csv;
  EXPECT_NE(csv.find(",0.62; 0.38,,"), std::string::npos) << csv;
  EXPECT_NE(csv.find(",1,Bob,8.5\r\n"), std::string::npos) << csv;
  const auto json = nlohmann::json::parse(matches_json(matches));
  EXPECT_EQ(json[0]["teams"][0]["players"][0]["share"], 0.62);
  EXPECT_EQ(json[0]["teams"][0]["players"][0]["left"], false);
  EXPECT_EQ(json[0]["teams"][1]["players"][0]["left"], true);
  const auto fame = nlohmann::json::parse(standings_json(standings(matches)));
  int not_counted = 0;
  for (const auto& one : fame) not_counted += one["not_counted"].get<int>();
  EXPECT_EQ(not_counted, 2);
}

TEST(Text, TablesShowNoControlCharacters) {
  std::vector<MatchResult> matches = awkward();
  matches[0].teams[0].players[0].name = "\x1b[31mred\n";
  for (const std::string& text : {matches_table(matches), standings_table(standings(matches))}) {
    EXPECT_EQ(text.find('\x1b'), std::string::npos);
    EXPECT_NE(text.find("?[31mred?"), std::string::npos) << text;
  }
}

}  // namespace
}  // namespace results
