#include "server/game_choice.h"

#include <gtest/gtest.h>

#include "wire/enums.h"

namespace server {
namespace {

using foosball::Mode;
using foosball::PlayStyle;

constexpr auto kMatch = number(wire::Mode::match), kTraining = number(wire::Mode::training),
               kChallenge = number(wire::Mode::challenge), kLadder = number(wire::Mode::ladder);

wire::Game game(std::uint8_t mode, std::uint8_t goals = 0, std::uint8_t sets = 0,
                std::uint32_t match_ms = 0, std::uint8_t level = 0, std::uint8_t style = 0) {
  wire::Game asked;
  asked.mode = mode;
  asked.goals = goals;
  asked.sets = sets;
  asked.match_ms = match_ms;
  asked.level = level;
  asked.style = style;
  return asked;
}

constexpr GameSite kHome{.computer = true};

TEST(GameChoice, EveryModeCanBeChosenWhereAComputerPlays) {
  for (const std::uint8_t mode : {kMatch, kTraining, kChallenge, kLadder})
    EXPECT_TRUE(why_not(game(mode), kHome).empty()) << int{mode};
  EXPECT_TRUE(why_not(game(kMatch, 99, 17, 3'600'000, 5, 4), kHome).empty());
  EXPECT_TRUE(why_not(game(kTraining, 0, 0, 0, 1, 1), kHome).empty());
  EXPECT_TRUE(why_not(game(kLadder, 3, 1), kHome).empty());
}

TEST(GameChoice, NumbersOutOfRangeHaveASentence) {
  wire::Game dated = game(kMatch);
  dated.date = 20261122;
  for (const wire::Game& asked :
       {game(kMatch, 100), game(kMatch, 0, 2), game(kMatch, 0, 19), game(kMatch, 0, 255),
        game(kMatch, 0, 0, 3'600'001), game(kMatch, 0, 0, 0xFFFFFFFF), game(kMatch, 0, 0, 0, 6),
        game(kMatch, 0, 0, 0, 255), game(kMatch, 0, 0, 0, 2, 5), game(kMatch, 0, 0, 0, 0, 1),
        game(9), dated}) {
    EXPECT_EQ(why_not(asked, kHome), wire::make_sentence<wire::SentenceId::no_such_game>());
  }
}

TEST(GameChoice, WhatTheModeDecidesCannotBeChosenWithIt) {
  using wire::make_sentence;
  using wire::SentenceId;
  EXPECT_EQ(why_not(game(kChallenge, 3), kHome), make_sentence<SentenceId::challenge_is_set>());
  EXPECT_EQ(why_not(game(kChallenge, 0, 0, 0, 4), kHome),
            make_sentence<SentenceId::challenge_is_set>());
  wire::Game itsf = game(kChallenge);
  itsf.rule_set = number(wire::RuleSet::itsf);
  EXPECT_EQ(why_not(itsf, kHome), make_sentence<SentenceId::challenge_is_set>());
  EXPECT_EQ(why_not(game(kTraining, 3), kHome), make_sentence<SentenceId::training_has_no_end>());
  EXPECT_EQ(why_not(game(kTraining, 0, 0, 60'000), kHome),
            make_sentence<SentenceId::training_has_no_end>());
  EXPECT_EQ(why_not(game(kLadder, 0, 0, 0, 3), kHome),
            make_sentence<SentenceId::ladder_has_its_levels>());
}

TEST(GameChoice, AChallengeIsPlayedOnlyWhereItIsTheSameAsEverywhere) {
  using wire::make_sentence;
  using wire::SentenceId;
  foosball::MatchDesc match;
  EXPECT_TRUE(why_not(game(kChallenge), site_of(match, true, false)).empty());
  EXPECT_EQ(why_not(game(kChallenge), site_of(match, false, false)),
            make_sentence<SentenceId::no_computer_here>());
  EXPECT_EQ(why_not(game(kLadder), site_of(match, false, false)),
            make_sentence<SentenceId::no_computer_here>());
  EXPECT_TRUE(why_not(game(kTraining), site_of(match, false, false)).empty());
  match.layout = foosball::Layout::paper;
  EXPECT_EQ(why_not(game(kChallenge), site_of(match, true, false)),
            make_sentence<SentenceId::challenge_table>());
  EXPECT_TRUE(why_not(game(kLadder), site_of(match, true, false)).empty());
  match = {};
  match.characters.push_back(match.characters.front());
  EXPECT_TRUE(why_not(game(kChallenge), site_of(match, true, false)).empty())
      << "own ones come after";
  match.characters.front().body.mass *= 1.01;
  EXPECT_EQ(why_not(game(kChallenge), site_of(match, true, false)),
            make_sentence<SentenceId::challenge_characters>());
  match = {};
  match.tuning.gravity = 9.0;
  EXPECT_EQ(why_not(game(kChallenge), site_of(match, true, false)),
            make_sentence<SentenceId::challenge_tuning>());
}

TEST(GameChoice, SidesAreChangedBetweenTheSetsOfACabinet) {
  using wire::make_sentence;
  using wire::SentenceId;
  wire::Game asked = game(kMatch, 0, 3);
  asked.change_sides = true;
  const GameSite cabinet{.cabinet = true};
  EXPECT_TRUE(why_not(asked, cabinet).empty());
  EXPECT_EQ(why_not(asked, kHome), make_sentence<SentenceId::sides_at_a_cabinet>());
  for (const std::uint8_t sets : {std::uint8_t{0}, std::uint8_t{1}}) {
    asked.sets = sets;
    EXPECT_EQ(why_not(asked, cabinet), make_sentence<SentenceId::sides_between_sets>())
        << int{sets};
  }
  asked.sets = 0;
  asked.rule_set = number(wire::RuleSet::itsf);
  EXPECT_TRUE(why_not(asked, cabinet).empty()) << "the best of five";
}

TEST(GameChoice, WhoPlaysIsTheDaysInAChallengeAndByTheRungOnTheLadder) {
  const auto chosen = player_of({.level = 2, .style = 4});
  EXPECT_EQ(chosen.style, PlayStyle::gambler);
  EXPECT_EQ(player_in(Mode::match, 0, 0, chosen), chosen);
  EXPECT_EQ(player_in(Mode::training, 3, 20261122, chosen), chosen);
  for (int rung = 0; rung < foosball::kLadderRungs; ++rung)
    EXPECT_EQ(player_in(Mode::ladder, rung, 0, chosen).level, rung + 1);
  EXPECT_EQ(player_in(Mode::challenge, 0, 20261122, chosen),
            foosball::challenge_opponent(20261122));
}

TEST(GameChoice, IsToldAsItWasAskedFor) {
  wire::Game asked = game(kLadder, 3, 5, 90'000);
  asked.change_sides = true;
  EXPECT_EQ(to_game(setup_of(asked, 0), {}, false), asked);
  asked = game(kMatch, 7, 1, 0, 4, 2);
  EXPECT_EQ(to_game(setup_of(asked, 0), {4, 2}, false), asked);
  const wire::Game day = to_game(setup_of(game(kChallenge), 20261122), {4, 2}, true);
  EXPECT_EQ(day.level, foosball::challenge_opponent(20261122).level);
  EXPECT_EQ(day.style, 1 + static_cast<int>(foosball::challenge_opponent(20261122).style));
  EXPECT_TRUE(day.waits);
  for (int level = 1; level <= foosball::kLevels; ++level) {
    for (int style = 0; style <= foosball::kPlayStyles; ++style) {
      const Opponent opponent{level, style};
      EXPECT_EQ(player_of(opponent_of(player_of(opponent))), player_of(opponent));
    }
  }
}

TEST(GameChoice, TheDayIsThatOfTheDate) {
  EXPECT_EQ(day_of("2026-11-22T23:59:59Z"), 20261122u);
  EXPECT_EQ(day_of("2026-02-31T00:00:00Z"), 0u);
  EXPECT_EQ(day_of(""), 0u);
  EXPECT_EQ(day_of("no date at all"), 0u);
}

}  // namespace
}  // namespace server
