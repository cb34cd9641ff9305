#include "wish_rules.h"

#include <gtest/gtest.h>

namespace server {
namespace {

using Kind = foosball::Command::Kind;

TEST(WishRules, APlayerWishesForTheOwnTeamAndForTheMatch) {
  EXPECT_TRUE(may_wish(0, false, {Kind::push, 0, 0}));
  EXPECT_FALSE(may_wish(0, true, {Kind::push, 1, 0}));
  EXPECT_FALSE(may_wish(1, true, {Kind::choose_character, 0, 2}));
  EXPECT_TRUE(may_wish(1, false, {Kind::pause, 0, 1}));
  EXPECT_TRUE(may_wish(1, false, {Kind::restart, 0, 0}));
}

TEST(WishRules, WhatTheServerTellsTheMatchIsNoWish) {
  const auto formed = [](Kind kind, int value) {
    return well_formed({static_cast<std::uint8_t>(kind), 0, static_cast<std::uint8_t>(value)});
  };
  EXPECT_FALSE(formed(Kind::seat, 1));
  EXPECT_FALSE(formed(Kind::touch, 0));
  EXPECT_TRUE(formed(Kind::time_out, 0));
  EXPECT_TRUE(formed(Kind::feed, foosball::feed_value(foosball::Line::attack, 2)));
  EXPECT_FALSE(formed(Kind::feed, foosball::kFeedValues));
}

TEST(WishRules, AWatcherWishesOnlyAtTheServersMachine) {
  for (const auto kind : {Kind::push, Kind::choose_character, Kind::pause, Kind::restart}) {
    EXPECT_TRUE(may_wish(wire::kWatchOnly, true, {kind, 1, 0}));
    EXPECT_FALSE(may_wish(wire::kWatchOnly, false, {kind, 1, 0}));
  }
}

TEST(WishRules, AFewAtOnceAndThenAFewASecond) {
  const std::int64_t start = 7'000'000'000;
  WishAllowance allowance;
  int taken = 0;
  for (int i = 0; i < 1000; ++i) taken += allowance.take(start);
  EXPECT_EQ(taken, WishAllowance::kAtOnce);
  // For ten seconds a wish each millisecond.
  for (int ms = 1; ms <= 10'000; ++ms) taken += allowance.take(start + ms * 1000);
  EXPECT_EQ(taken, WishAllowance::kAtOnce + 200);
  // Rest earns no more than a few at once.
  taken = 0;
  for (int i = 0; i < 1000; ++i) taken += allowance.take(start + 3'600'000'000);
  EXPECT_EQ(taken, WishAllowance::kAtOnce);
}

}  // namespace
}  // namespace server
