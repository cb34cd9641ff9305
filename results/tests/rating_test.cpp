#include "results/rating.h"

#include <gtest/gtest.h>

#include <algorithm>

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
}

// Regression: the fastest shot of a match was credited to both teams.
TEST(Rating, TellsTheFastestShotAndTheSavesOfTheOwnTeams) {
  std::vector<MatchResult> matches{match_between("Ann", "Bob", 5, 3, 1),
                                   match_between("Ann", "Bob", 3, 5, 2)};
  matches[1].teams[0].statistics->fastest_shot = 7.0;
  matches[1].teams[1].statistics->saves = 0;
  const auto all = standings(matches);
  const auto ann = std::ranges::find(all, "Ann", &Standing::name);
  const auto bob = std::ranges::find(all, "Bob", &Standing::name);
  EXPECT_DOUBLE_EQ(ann->fastest_shot, 9.25);
  EXPECT_DOUBLE_EQ(bob->fastest_shot, 8.5);
  EXPECT_EQ(ann->shots_faced, 2u) << "Bob's on target, of both matches";
  EXPECT_EQ(ann->saves, 4u);
  EXPECT_DOUBLE_EQ(*ann->saved(), 1.0) << "never above all";
  EXPECT_DOUBLE_EQ(*bob->saved(), 0.4);
  matches[1].teams[0].statistics->fastest_shot.reset();
  matches[0].teams[0].statistics.reset();
  for (const Standing& one : standings(matches))
    EXPECT_DOUBLE_EQ(one.fastest_shot, one.name == "Bob" ? 8.5 : 0.0) << "not known";
}

// By hand: at 1516 against 1484, E of the weaker is 1 / (1 + 10^(32/400)) = 0.454078...
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

TEST(Rating, CountsAMatchOnlyForWhoPlayedAlmostAllOfIt) {
  MatchResult match = match_between("Ann", "Bob", 5, 3);
  match.teams[0].players = {{"Ann", "person", 0.6}, {"computer 2", "computer", 0.4}};
  const auto all = standings(std::vector{match});
  EXPECT_DOUBLE_EQ(rating(all, "Ann"), kFirstRating) << "the computer won it for her";
  EXPECT_DOUBLE_EQ(rating(all, "computer 2"), kFirstRating);
  EXPECT_DOUBLE_EQ(rating(all, "Bob"), 1484.0) << "he played all of it";
  for (const Standing& s : all) {
    EXPECT_EQ(s.matches, s.name == "Bob" ? 1u : 0u) << s.name;
    EXPECT_EQ(s.not_counted, s.name == "Bob" ? 0u : 1u) << s.name;
  }
  EXPECT_DOUBLE_EQ(rating_of(match.teams[0], all), kFirstRating);
  match.teams[0].players = {{"Ann", "person", 1.0 - kLargestAbsence}, {"Cleo", "person", 0.89}};
  const auto more = standings(std::vector{match});
  EXPECT_DOUBLE_EQ(rating(more, "Ann"), 1516.0) << "a moment's absence";
  EXPECT_DOUBLE_EQ(rating(more, "Cleo"), kFirstRating);
  EXPECT_DOUBLE_EQ(rating_of(match.teams[0], more), 1516.0);
}

TEST(Rating, WhoLeavesHasLostWhateverTheTeamDoesThen) {
  for (const auto& [own, theirs] : {std::pair{5u, 3u}, {3u, 5u}, {4u, 4u}}) {
    MatchResult match = match_between("Bob", "Cleo", own, theirs);
    match.teams[0].players.push_back({"Ann", "person", 0.5, true});
    const auto all = standings(std::vector{match});
    EXPECT_DOUBLE_EQ(rating(all, "Ann"), 1484.0) << own << ":" << theirs;
    const double bob = own > theirs ? 1516.0 : own < theirs ? 1484.0 : kFirstRating;
    EXPECT_DOUBLE_EQ(rating(all, "Bob"), bob) << "who stayed has the team's result";
    EXPECT_DOUBLE_EQ(rating(all, "Cleo"), 2.0 * kFirstRating - bob);
    const auto ann = std::ranges::find(all, "Ann", &Standing::name);
    EXPECT_EQ(ann->losses, 1u);
    EXPECT_EQ(ann->wins + ann->not_counted, 0u);
  }
}

TEST(Rating, IsNotSavedByLeavingInTheLastMoment) {
  MatchResult match = match_between("Ann", "Bob", 5, 3);
  match.teams[0].players = {{"Ann", "person", 0.99, true}};
  EXPECT_DOUBLE_EQ(rating(standings(std::vector{match}), "Ann"), 1484.0) << "nor won so";
}

// Otherwise a player could exclude the match from all ratings by changing teams.
TEST(Rating, IsMovedThoughSomebodyWentOverToTheOtherTeam) {
  MatchResult match = match_between("Bob", "Cleo", 5, 3);
  match.teams[1].players.push_back({"Ann", "person", 0.05, true});
  match.teams[0].players.push_back({"Ann", "person", 0.95});
  EXPECT_DOUBLE_EQ(rating(standings(std::vector{match}), "Bob"), 1516.0);
}

// By hand: 0.75 of 1516 and 0.25 of 1484 are 1508; E of 1484 against it is 0.465516
TEST(Rating, WeighsATeamByWhoPlayedHowMuchOfTheMatch) {
  MatchResult second = match_between("Ann", "Bob", 2, 5, 2);
  second.teams[0].players = {{"Ann", "person", 0.75}, {"Bob's double", "person", 0.25}};
  MatchResult third = match_between("Bob's double", "Cleo", 3, 5, 1);
  const std::vector<MatchResult> matches{match_between("Ann", "Bob", 5, 3), third, second};
  EXPECT_NEAR(rating(standings(matches), "Bob"), 1484.0 + 32.0 * (1.0 - 0.465516), 1e-4);
}

TEST(Rating, IsMovedThoughTheSameComputerStoodInOnBothSides) {
  MatchResult match = match_between("Ann", "Bob", 5, 3);
  for (Team& team : match.teams) {
    team.players[0].share = 0.95;
    team.players.push_back({"computer 2", "computer", 0.05});
  }
  EXPECT_GT(rating(standings(std::vector{match}), "Ann"), kFirstRating);
}

TEST(Rating, IsMovedByNoDrawAndByNobodyAgainstHimself) {
  const std::vector<MatchResult> matches{match_between("Ann", "Bob", 4, 4, 1),
                                         match_between("Ann", "Ann", 5, 1, 2)};
  for (const Standing& s : standings(matches)) EXPECT_DOUBLE_EQ(s.rating, kFirstRating);
  EXPECT_TRUE(standings({}).empty());
}

}  // namespace
}  // namespace results
