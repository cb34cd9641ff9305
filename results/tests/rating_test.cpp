#include "results/rating.h"

#include <gtest/gtest.h>

#include "samples.h"

namespace results {
namespace {

double rating(const std::vector<Standing>& all, const std::string& name) {
  for (const Standing& s : all) {
    if (s.name == name) return s.rating;
  }
  ADD_FAILURE() << name;
  return 0.0;
}

TEST(Rating, OfEqualsHalfTheGainGoesOver) {
  const std::vector<MatchResult> matches{match_between("Ann", "Bob", 5, 3)};
  const auto all = standings(matches);
  ASSERT_EQ(all.size(), 2u);
  EXPECT_EQ(all[0].name, "Ann");
  EXPECT_DOUBLE_EQ(all[0].rating, 1516.0);
  EXPECT_DOUBLE_EQ(all[1].rating, 1484.0);
  EXPECT_EQ(all[0].wins, 1u);
  EXPECT_EQ(all[1].losses, 1u);
  EXPECT_EQ(all[0].goals_for, 5u);
  EXPECT_EQ(all[0].goals_against, 3u);
  EXPECT_DOUBLE_EQ(all[1].fastest_shot, 9.25);
}

// By hand: after 1516 against 1484, E of the weaker is 1 / (1 + 10^(32/400)) = 0.454078...
TEST(Rating, WhoIsExpectedToLoseGainsMore) {
  const std::vector<MatchResult> matches{match_between("Ann", "Bob", 5, 3, 1),
                                         match_between("Ann", "Bob", 2, 5, 2)};
  const auto all = standings(matches);
  EXPECT_NEAR(rating(all, "Bob"), 1484.0 + 32.0 * (1.0 - 0.45407807), 1e-4);
  EXPECT_NEAR(rating(all, "Ann") + rating(all, "Bob"), 3000.0, 1e-9);
}

TEST(Rating, ATeamIsRatedByTheMeanOfItsPlayersAndAllOfThemGain) {
  MatchResult match = match_between("Ann", "Bob", 5, 3);
  match.teams[0].players.push_back({"Cleo", "person"});
  const auto all = standings(std::vector{match});
  EXPECT_DOUBLE_EQ(rating(all, "Ann"), 1516.0);
  EXPECT_DOUBLE_EQ(rating(all, "Cleo"), 1516.0);
  EXPECT_DOUBLE_EQ(rating(all, "Bob"), 1484.0);
}

TEST(Rating, IsMovedByNoDrawAndByNobodyAgainstHimself) {
  const std::vector<MatchResult> matches{match_between("Ann", "Bob", 4, 4, 1),
                                         match_between("Ann", "Ann", 5, 1, 2)};
  for (const Standing& s : standings(matches)) EXPECT_DOUBLE_EQ(s.rating, kFirstRating);
  EXPECT_TRUE(standings({}).empty());
}

}  // namespace
}  // namespace results
