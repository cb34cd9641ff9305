// The page of the game, without drawing.
#include "client/game_menu.h"

#include <gtest/gtest.h>

#include <set>

#include "client/menu.h"
#include "times.h"
#include "wire/enums.h"
#include "wire/limits.h"

namespace client {
namespace {

// The game of a server that was started without options.
wire::Game usual() {
  wire::Game game;
  game.goals = 5;
  game.sets = 1;
  game.level = 2;
  return game;
}

class GamePage : public testing::Test {
 protected:
  GamePage() { menu.update(1, reported, true, ""); }
  const MenuRow& row(const std::string& label) {
    shown = menu.page(0);
    for (const MenuRow& one : shown.rows)
      if (one.label == label) return one;
    ADD_FAILURE() << "no row " << label;
    return shown.rows.front();
  }
  int index(const std::string& label) {
    row(label);
    for (std::size_t i = 0; i < shown.rows.size(); ++i)
      if (shown.rows[i].label == label) return static_cast<int>(i);
    return -1;
  }
  std::string value(const std::string& label) { return row(label).value; }
  void turn(const std::string& label, int way) { menu.step(index(label), {.right = way}); }
  // A server that grants every request, for this time; returns the number of requests.
  int grant(std::int64_t long_us = 2 * kSecond) {
    int asked = 0;
    for (const std::int64_t end = now + long_us; now < end; now += 16'000) {
      if (const auto game = menu.ask(now)) {
        ++asked;
        reported = last = *game;
        const bool dated = reported.mode == number(wire::Mode::challenge);
        if (dated) reported.level = 4, reported.style = 1, reported.date = 20261122;
      }
      menu.update(1, reported, true, "");
    }
    return asked;
  }
  wire::Game reported = usual(), last;
  std::int64_t now = kSecond;
  GameMenu menu;
  MenuPage shown;
};

TEST_F(GamePage, ShowsWhatTheServerTells) {
  reported.mode = number(wire::Mode::ladder);
  reported.rule_set = number(wire::RuleSet::itsf);
  reported.goals = 7;
  reported.sets = 5;
  reported.match_ms = 90'000;
  reported.change_sides = true;
  menu.update(1, reported, true, "");
  EXPECT_EQ(value("Mode"), "ladder");
  EXPECT_EQ(value("Rules"), "tournament (ITSF)");
  EXPECT_EQ(value("Goals that win a set"), "7");
  EXPECT_EQ(value("Best of how many sets"), "5");
  EXPECT_EQ(value("Minutes of a set"), "1.5");
  EXPECT_EQ(value("Change sides between sets"), "on");
  EXPECT_EQ(grant(), 0) << "nothing was changed";
}

TEST_F(GamePage, EveryModeIsReachedAndAskedForOnceAlone) {
  std::set<int> modes;
  for (unsigned i = 0; i < wire::kModeCount; ++i) {
    turn("Mode", 1);
    EXPECT_EQ(grant(), 1);
    modes.insert(reported.mode);
    EXPECT_EQ(menu.wanted().mode, reported.mode);
  }
  EXPECT_EQ(modes.size(), wire::kModeCount);
}

TEST_F(GamePage, StepsInARowAreOneRequest) {
  for (int i = 0; i < 3; ++i) {
    turn("Goals that win a set", -1);
    EXPECT_EQ(grant(kSecond / 10), 0) << "another step may follow";
  }
  EXPECT_EQ(grant(), 1);
  EXPECT_EQ(last.goals, 2);
}

TEST_F(GamePage, WhatTheModeDecidesIsFixedAndNotAskedFor) {
  turn("Computer's level", 1);
  turn("Goals that win a set", 1);
  grant();
  turn("Mode", 2);
  grant();
  EXPECT_EQ(last.mode, number(wire::Mode::challenge));
  EXPECT_EQ(last.goals, 0);
  EXPECT_EQ(last.level, 0);
  EXPECT_EQ(last.date, 0u);
  for (const char* label :
       {"Computer's level", "Computer's style", "Rules", "Goals that win a set",
        "Best of how many sets", "Minutes of a set", "Change sides between sets"})
    EXPECT_TRUE(row(label).fixed) << label;
  EXPECT_EQ(value("Computer's level"), "4") << "the day's opponent is shown";
  EXPECT_EQ(value("Minutes of a set"), "2");
  turn("Goals that win a set", 1);
  EXPECT_EQ(grant(), 0);
  turn("Mode", 1);
  grant();
  EXPECT_EQ(last.mode, number(wire::Mode::ladder));
  EXPECT_EQ(last.level, 0);
  EXPECT_TRUE(row("Computer's level").fixed);
  EXPECT_FALSE(row("Goals that win a set").fixed);
  turn("Mode", 1);
  grant();
  EXPECT_EQ(last.mode, number(wire::Mode::match));
  EXPECT_EQ(last.level, 3) << "as it was chosen before";
  EXPECT_EQ(last.goals, 6);
}

TEST_F(GamePage, NumbersStayInTheirRanges) {
  for (int i = 0; i < 130; ++i) {
    for (const char* label :
         {"Goals that win a set", "Best of how many sets", "Minutes of a set", "Computer's level"})
      turn(label, 1);
  }
  grant();
  EXPECT_EQ(last.goals, 99);
  EXPECT_EQ(last.sets, 17);
  EXPECT_EQ(last.match_ms, 3'600'000u);
  EXPECT_EQ(last.level, 5);
  for (int i = 0; i < 130; ++i) {
    for (const char* label : {"Goals that win a set", "Best of how many sets", "Computer's level"})
      turn(label, -1);
  }
  EXPECT_EQ(value("Goals that win a set"), "no limit") << "time ends it";
  for (int i = 0; i < 20; ++i) turn("Minutes of a set", -1);
  EXPECT_EQ(value("Goals that win a set"), "5");
  for (int i = 0; i < 20; ++i) turn("Goals that win a set", -1);
  grant();
  EXPECT_EQ(last.goals, 1);
  EXPECT_EQ(last.sets, 1);
  EXPECT_EQ(last.match_ms, 0u);
  EXPECT_EQ(last.level, 1);
}

TEST_F(GamePage, OtherRulesComeWithTheirOwnGoalsAndSets) {
  turn("Rules", 1);
  EXPECT_EQ(value("Best of how many sets"), "5");
  grant();
  turn("Rules", 1);
  EXPECT_EQ(value("Best of how many sets"), "1");
}

TEST_F(GamePage, OnlyAHostChanges) {
  menu.update(1, reported, false, "");
  for (const MenuRow& one : menu.page(0).rows) EXPECT_TRUE(one.fixed) << one.label;
  EXPECT_NE(menu.page(0).note, "");
  for (int i = 0; i < menu.rows(); ++i) EXPECT_FALSE(menu.step(i, {.right = 1, .confirm = true}));
  EXPECT_FALSE(menu.ask(now + kSecond));
}

TEST_F(GamePage, AGameThatWaitsIsSaidAndBegunByARestart) {
  const int begin = menu.rows() - 1;
  EXPECT_TRUE(menu.page(begin).rows.back().fixed);
  EXPECT_FALSE(menu.step(begin, {.confirm = true})) << "no game is waiting";
  const std::string before = menu.page(0).note;
  reported.waits = true;
  menu.update(1, reported, true, "");
  EXPECT_NE(menu.page(0).note, before);
  EXPECT_FALSE(menu.step(begin, {.right = 1})) << "no match ends by a slip";
  EXPECT_TRUE(menu.step(begin, {.confirm = true}));
}

TEST_F(GamePage, ARefusedRequestIsGivenUpAndItsReasonShown) {
  turn("Mode", 1);
  int asked = 0;
  for (const std::int64_t end = now + 10 * kSecond; now < end; now += 16'000) {
    asked += menu.ask(now) ? 1 : 0;
    menu.update(1, reported, true, asked > 0 ? "why not" : "");
  }
  EXPECT_EQ(asked, GameMenu::kTries);
  EXPECT_EQ(menu.page(0).detail, "why not");
  EXPECT_EQ(value("Mode"), "match") << "as it is";
}

TEST_F(GamePage, WhatWasWantedOfAnotherSessionIsForgotten) {
  turn("Mode", 1);
  menu.update(2, reported, true, "");
  EXPECT_FALSE(menu.ask(now + kSecond));
  EXPECT_EQ(value("Mode"), "match");
  menu.update(2, std::nullopt, true, "");
  EXPECT_FALSE(menu.page(0).rows.empty());
  for (int i = 0; i < menu.rows(); ++i) EXPECT_FALSE(menu.step(i, {.right = 1, .confirm = true}));
}

TEST(Menu, AsksForARestartFromThePageOfTheGame) {
  Settings settings;
  const SeatsView nothing;
  Menu menu("");
  wire::Game reported = usual();
  reported.waits = true;
  menu.game().update(1, reported, true, "");
  const Menu::Context context{settings, nothing, nullptr};
  menu.toggle(Menu::Page::game);
  EXPECT_EQ(menu.page(context).title, "Game");
  const auto outcome = menu.step({.down = menu.game().rows() - 1, .confirm = true}, 0, context);
  ASSERT_EQ(outcome.asked.requests.size(), 1u);
  EXPECT_EQ(outcome.asked.requests[0].kind, number(wire::RequestKind::restart));
}

}  // namespace
}  // namespace client
