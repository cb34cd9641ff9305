// Who has played a match, and for how much of it.
#include "lineup.h"

#include <gtest/gtest.h>

namespace server {
namespace {

using Kind = Lineup::Kind;
using Players = std::vector<results::Player>;

void play(Lineup& lineup, int ticks, const std::vector<std::pair<Kind, const char*>>& team0) {
  for (int i = 0; i < ticks; ++i) {
    lineup.begin_tick();
    for (const auto& [kind, name] : team0) lineup.add(0, kind, name);
  }
}

TEST(Lineup, GivesEachTheShareOfTheMatchThatItHasPlayed) {
  Lineup lineup;
  play(lineup, 250, {{Kind::computer, "computer 2"}, {Kind::person, "Bob"}});
  play(lineup, 750, {{Kind::person, "Ann"}, {Kind::person, "Bob"}});
  EXPECT_EQ(
      lineup.players(0),
      (Players{{"Bob", "person", 1.0}, {"Ann", "person", 0.75}, {"computer 2", "computer", 0.25}}));
  EXPECT_TRUE(lineup.players(1).empty());
}

TEST(Lineup, CountsATickOnceThoughAPlayerHasTwoSeats) {
  Lineup lineup;
  play(lineup, 10, {{Kind::person, "Ann"}, {Kind::person, "Ann"}});
  EXPECT_EQ(lineup.players(0), (Players{{"Ann", "person", 1.0}}));
}

TEST(Lineup, LeavesOutWhoPlayedAMomentAndNobodyElseHoweverManyCome) {
  Lineup lineup;
  for (int i = 0; i < 100; ++i) {
    const std::string name = "passer-by " + std::to_string(i);
    play(lineup, 5, {{Kind::person, name.c_str()}, {Kind::person, "Ann"}});
  }
  play(lineup, 500, {{Kind::person, "Ann"}});
  EXPECT_EQ(lineup.players(0), (Players{{"Ann", "person", 1.0}}));
}

TEST(Lineup, BeginsAnewWithEachMatch) {
  Lineup lineup;
  play(lineup, 10, {{Kind::person, "Ann"}});
  lineup.begin();
  EXPECT_TRUE(lineup.players(0).empty());
  play(lineup, 10, {{Kind::person, ""}});
  EXPECT_EQ(lineup.players(0), (Players{{"person", "person", 1.0}}));
}

}  // namespace
}  // namespace server
