#include "request_rules.h"

#include <gtest/gtest.h>

namespace server {
namespace {

using CommandKind = foosball::Command::Kind;

TEST(RequestRules, APlayerAsksForTheOwnTeamAndVotesOnWhatConcernsBoth) {
  EXPECT_EQ(rule(wire::Role::player, 0, {CommandKind::push, 0, 0}), Ruling::yes);
  EXPECT_EQ(rule(wire::Role::player, 0, {CommandKind::push, 1, 0}), Ruling::no);
  EXPECT_EQ(rule(wire::Role::player, 1, {CommandKind::choose_character, 0, 2}), Ruling::no);
  EXPECT_EQ(rule(wire::Role::player, 1, {CommandKind::pause, 0, 1}), Ruling::vote);
  EXPECT_EQ(rule(wire::Role::player, 1, {CommandKind::restart, 0, 0}), Ruling::vote);
  EXPECT_EQ(rule(wire::Role::player, wire::kWatchOnly, {CommandKind::restart, 0, 0}), Ruling::no);
}

TEST(RequestRules, WhatTheServerTellsTheMatchIsNoRequest) {
  const auto formed = [](CommandKind kind, int value) {
    return well_formed({static_cast<std::uint8_t>(kind), 0, static_cast<std::uint8_t>(value)});
  };
  EXPECT_FALSE(formed(CommandKind::seat, 1));
  EXPECT_FALSE(formed(CommandKind::touch, 0));
  EXPECT_TRUE(formed(CommandKind::time_out, 0));
  EXPECT_TRUE(formed(CommandKind::feed, foosball::feed_value(foosball::Line::attack, 2)));
  EXPECT_FALSE(formed(CommandKind::feed, foosball::kFeedValues));
}

// Otherwise each value would be a separate question, and its votes would not add up.
TEST(RequestRules, AValueThatMeansNothingMakesNoOtherRequestOfIt) {
  for (const CommandKind kind : {CommandKind::restart, CommandKind::push, CommandKind::time_out}) {
    const wire::MatchRequest request{static_cast<std::uint8_t>(kind), 1, 7};
    ASSERT_TRUE(well_formed(request));
    EXPECT_EQ(command_of(request).value, 0);
  }
  EXPECT_EQ(command_of({static_cast<std::uint8_t>(CommandKind::pause), 0, 1}).value, 1);
}

TEST(RequestRules, AHostDecidesForAllButPlaysNobodyElsesTeam) {
  for (const auto kind : {CommandKind::push, CommandKind::choose_character, CommandKind::pause,
                          CommandKind::restart}) {
    EXPECT_EQ(rule(wire::Role::host, wire::kWatchOnly, {kind, 1, 0}), Ruling::yes);
    EXPECT_EQ(rule(wire::Role::watcher, wire::kWatchOnly, {kind, 1, 0}), Ruling::no);
  }
  EXPECT_EQ(rule(wire::Role::host, 0, {CommandKind::restart, 0, 0}), Ruling::yes);
  EXPECT_EQ(rule(wire::Role::host, 0, {CommandKind::push, 1, 0}), Ruling::no);
}

TEST(RequestRules, TheHostTunesAndNobodyElse) {
  for (const std::uint8_t team : {std::uint8_t{0}, std::uint8_t{1}, wire::kWatchOnly}) {
    EXPECT_EQ(rule(wire::Role::host, team, {CommandKind::tune, 0, 3, 1.0}), Ruling::yes);
    EXPECT_EQ(rule(wire::Role::player, team, {CommandKind::tune, 0, 3, 1.0}), Ruling::no);
    EXPECT_EQ(rule(wire::Role::watcher, team, {CommandKind::tune, 0, 3, 1.0}), Ruling::no);
  }
  const auto formed = [](int value, double amount) {
    return well_formed({static_cast<std::uint8_t>(CommandKind::tune), 0,
                        static_cast<std::uint8_t>(value), amount});
  };
  for (int value = 0; value < foosball::kTuningValues; ++value) {
    const auto& field = foosball::kTuningFields[static_cast<std::size_t>(value)];
    EXPECT_TRUE(formed(value, field.min) && formed(value, field.max)) << field.name;
    EXPECT_FALSE(formed(value, field.min - 1.0) || formed(value, field.max + 1.0)) << field.name;
  }
  EXPECT_FALSE(formed(foosball::kTuningValues, 1.0));
}

TEST(RequestRules, AFewAtOnceAndThenAFewASecond) {
  const std::int64_t start = 7'000'000'000;
  RequestAllowance allowance;
  int taken = 0;
  for (int i = 0; i < 1000; ++i) taken += allowance.take(start);
  EXPECT_EQ(taken, RequestAllowance::kAtOnce);
  // For ten seconds, a request each millisecond.
  for (int ms = 1; ms <= 10'000; ++ms) taken += allowance.take(start + ms * 1000);
  EXPECT_EQ(taken, RequestAllowance::kAtOnce + 200);
  // Waiting longer does not increase the burst.
  taken = 0;
  for (int i = 0; i < 1000; ++i) taken += allowance.take(start + 3'600'000'000);
  EXPECT_EQ(taken, RequestAllowance::kAtOnce);
}

}  // namespace
}  // namespace server
