// The variation of a character's number, and the opponents.
#include "match/character_study.h"

#include <gtest/gtest.h>

#include <set>

namespace match {
namespace {

const foosball::Characters& all() {
  return foosball::built_in_characters();
}

TEST(VariedNumber, IsReadFromItsText) {
  const auto varied = parse_varied(all()[2].name + ":mass=0.05:0.09:3", all());
  ASSERT_TRUE(varied.has_value()) << varied.error();
  EXPECT_EQ(varied->character, 2u);
  EXPECT_STREQ(foosball::kBodyFields[varied->field].name, "mass");
  EXPECT_EQ(varied->value(0), 0.05);
  EXPECT_NEAR(varied->value(1), 0.07, 1e-15);
  EXPECT_EQ(varied->value(2), 0.09);
  EXPECT_EQ(parse_varied(all()[0].name + ":bounce=1:2", all())->steps, 5);
}

TEST(VariedNumber, IsRefusedWithWhatIsWrong) {
  const std::string name = all()[0].name;
  const std::pair<std::string, const char*> cases[] = {
      {"", "no number of a character"},
      {name + "=1:2", "no number of a character"},
      {"nobody:mass=0.05:0.09", "there is no \"nobody\""},
      {name + ":colour=0:1", "there is no \"colour\""},
      {name + ":mass=0.05", "are numbers"},
      {name + ":mass=0.05:0.09:3:4", "are numbers"},
      {name + ":mass=0.05:heavy", "are numbers"},
      {name + ":mass=0.05:nan", "out of the range"},
      {name + ":mass=0.05:9", "9 is out of the range"},
      {name + ":mass=0.05:0.09:1", "STEPS"},
      {name + ":mass=0.05:0.09:nan", "STEPS"}};
  for (const auto& [text, sentence] : cases) {
    const auto varied = parse_varied(text, all());
    ASSERT_FALSE(varied.has_value()) << text;
    EXPECT_NE(varied.error().find(sentence), std::string::npos) << varied.error();
  }
}

TEST(VariedNumber, ChangesThatOfOneCharacterAlone) {
  const auto varied = parse_varied(all()[1].name + ":restitution=0.5:0.9:3", all());
  ASSERT_TRUE(varied.has_value());
  SeriesDesc base;
  const auto series = varied_series(base, *varied);
  ASSERT_EQ(series.size(), 3u);
  std::set<int> opponents;
  for (int step = 0; step < 3; ++step) {
    const SeriesDesc& desc = series[static_cast<std::size_t>(step)];
    foosball::Characters expected = all();
    expected[1].body.restitution = varied->value(step);
    EXPECT_EQ(desc.character_list, expected);
    for (std::uint64_t pair = 0; pair < 60; ++pair) {
      const GameDesc game = Series(desc).game(2 * pair);
      EXPECT_EQ(game.characters[0], 1);
      opponents.insert(game.characters[1]);
    }
  }
  EXPECT_EQ(opponents, (std::set<int>{0, 2, 3, 4, 5}));
}

// Twenty matches at each value, of which the character wins the given number of tenths.
std::vector<Series> played(const VariedNumber& varied, std::initializer_list<int> tenths) {
  std::vector<Series> series;
  for (const int wins : tenths) {
    SeriesDesc desc = varied_series({}, varied)[0];
    desc.max_games = 20;
    series.emplace_back(desc);
    for (int game = 0; game < 20; ++game) {
      GameResult result;
      const int first = game % 2;
      result.winner = game / 2 < wins ? first : 1 - first;
      series.back().take(result);
    }
  }
  return series;
}

TEST(VariedNumber, HasItsBalanceWhereTheLineThroughThePointsMeetsAHalf) {
  const VariedNumber varied{.character = 0, .field = 6, .low = 0.04, .high = 0.08, .steps = 2};
  const auto figures = varied_figures(varied, played(varied, {4, 6}));
  ASSERT_EQ(figures.size(), 3u);
  EXPECT_NEAR(figures[0].value, 40.0, 1e-9);
  EXPECT_NEAR(figures[1].value, 60.0, 1e-9);
  EXPECT_NEAR(figures[2].value, 0.06, 1e-9);
  // Printed with all digits, for use in a file, instead of "0.06" for anything from 0.055 to 0.065.
  const VariedNumber wide{.character = 0, .field = 6, .low = 0.04, .high = 0.084, .steps = 2};
  EXPECT_NE(as_table(varied_figures(wide, played(wide, {4, 6}))).find(" 0.062 "),
            std::string::npos);
}

TEST(VariedNumber, SaysThatAValueLiesOutsideOfWhatWasPlayed) {
  const VariedNumber varied{.character = 0, .field = 6, .low = 0.04, .high = 0.08, .steps = 2};
  EXPECT_NE(varied_figures(varied, played(varied, {6, 7}))[2].name.find("outside"),
            std::string::npos);
  EXPECT_EQ(varied_figures(varied, played(varied, {4, 6}))[2].name.find("outside"),
            std::string::npos);
}

TEST(Traits, AreMeasuredOfEachCharacterAgainstItself) {
  const auto series = trait_series({});
  ASSERT_EQ(series.size(), all().size());
  for (std::size_t c = 0; c < series.size(); ++c) {
    const GameDesc game = Series(series[c]).game(1);
    EXPECT_EQ(game.characters[0], static_cast<int>(c));
    EXPECT_EQ(game.characters[1], static_cast<int>(c));
  }
}

}  // namespace
}  // namespace match
