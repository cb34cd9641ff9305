// The players of a match, and their shares of play.
#include "lineup.h"

#include <gtest/gtest.h>

#include <functional>

namespace server {
namespace {

using Kind = Lineup::Kind;
using Players = std::vector<results::Player>;
constexpr std::uint64_t kReturnTicks = 300;

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
      lineup.players(0, kReturnTicks),
      (Players{{"Bob", "person", 1.0}, {"Ann", "person", 0.75}, {"computer 2", "computer", 0.25}}))
      << "Ann came late: she has not left";
  EXPECT_TRUE(lineup.players(1, kReturnTicks).empty());
}

TEST(Lineup, CountsATickOnceThoughAPlayerHasTwoSeats) {
  Lineup lineup;
  play(lineup, 10, {{Kind::person, "Ann"}, {Kind::person, "Ann"}});
  EXPECT_EQ(lineup.players(0, kReturnTicks), (Players{{"Ann", "person", 1.0}}));
}

TEST(Lineup, LeavesOutWhoPlayedAMomentAndNobodyElseHoweverManyCome) {
  Lineup lineup;
  for (int i = 0; i < 100; ++i) {
    const std::string name = "passer-by " + std::to_string(i);
    play(lineup, 5, {{Kind::person, name.c_str()}, {Kind::person, "Ann"}});
  }
  play(lineup, 500, {{Kind::person, "Ann"}});
  EXPECT_EQ(lineup.players(0, kReturnTicks), (Players{{"Ann", "person", 1.0}}));
}

// Ann plays 500 of 1000 ticks first, then does what `rest` does.
bool has_left(const std::function<void(Lineup&)>& rest) {
  Lineup lineup;
  play(lineup, 500, {{Kind::person, "Ann"}, {Kind::person, "Bob"}});
  rest(lineup);
  for (const results::Player& player : lineup.players(0, kReturnTicks))
    if (player.name == "Ann") return player.left;
  ADD_FAILURE() << "she has played";
  return false;
}

TEST(Lineup, TellsWhoHasLeftFromWhoIsThereAtTheEnd) {
  const auto bob = std::vector<std::pair<Kind, const char*>>{{Kind::person, "Bob"}};
  const auto both =
      std::vector<std::pair<Kind, const char*>>{{Kind::person, "Bob"}, {Kind::person, "Ann"}};
  EXPECT_TRUE(has_left([&](Lineup& lineup) { play(lineup, 500, bob); }));
  EXPECT_TRUE(has_left([&](Lineup& lineup) { play(lineup, 1, bob); })) << "in the last moment";
  EXPECT_FALSE(has_left([&](Lineup& lineup) { play(lineup, 500, both); }));
  const auto away_for = [&](int ticks) {
    return [&, ticks](Lineup& lineup) {
      play(lineup, ticks, bob);
      play(lineup, 500 - ticks, both);
    };
  };
  EXPECT_FALSE(has_left(away_for(int(kReturnTicks)))) << "she was back in time";
  EXPECT_TRUE(has_left(away_for(int(kReturnTicks) + 1))) << "to be there at the end saves nothing";
}

TEST(Lineup, AddsUpTheAbsencesOfWhoKeepsTheSeat) {
  const auto absent = [](Lineup& lineup, int ticks) {
    for (int i = 0; i < ticks; ++i) {
      lineup.begin_tick();
      lineup.add(0, Kind::computer, "computer 2");
      lineup.keep_seat(0, "Ann");
    }
  };
  EXPECT_FALSE(has_left([&](Lineup& lineup) { absent(lineup, int(kReturnTicks)); }))
      << "she may still come back";
  EXPECT_TRUE(has_left([&](Lineup& lineup) {
    for (int i = 0; i < 4; ++i) {
      absent(lineup, int(kReturnTicks) / 3);
      play(lineup, 10, {{Kind::person, "Ann"}});
    }
  })) << "away again and again";
}

TEST(Lineup, ATenthOfALongMatchIsNotTooLong) {
  Lineup lineup;
  play(lineup, 4500, {{Kind::person, "Ann"}});
  play(lineup, 450, {{Kind::computer, "computer 2"}});
  play(lineup, 50, {{Kind::person, "Ann"}});
  EXPECT_EQ(lineup.players(0, kReturnTicks)[0], (results::Player{"Ann", "person", 0.91}));
}

TEST(Lineup, WhoIsPutOutHasNotLeftAndNeitherHasACabinetOrTheComputer) {
  EXPECT_FALSE(has_left([](Lineup& lineup) {
    lineup.excuse("Ann");
    play(lineup, 500, {{Kind::person, "Bob"}});
  }));
  Lineup lineup;
  play(lineup, 500, {{Kind::cabinet, "cabinet"}});
  play(lineup, 500, {{Kind::computer, "computer 2"}});
  play(lineup, 500, {{Kind::person, "Bob"}});
  for (const results::Player& player : lineup.players(0, kReturnTicks))
    EXPECT_FALSE(player.left) << player.name;
}

TEST(Lineup, BeginsAnewWithEachMatch) {
  Lineup lineup;
  play(lineup, 10, {{Kind::person, "Ann"}});
  lineup.begin();
  EXPECT_TRUE(lineup.players(0, kReturnTicks).empty());
  play(lineup, 10, {{Kind::person, ""}});
  EXPECT_EQ(lineup.players(0, kReturnTicks), (Players{{"person", "person", 1.0}}));
}

}  // namespace
}  // namespace server
