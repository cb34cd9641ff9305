// Determinism, saving, and two computer players against each other.
#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <functional>
#include <memory>
#include <vector>

#include "../src/match_save.h"
#include "foosball/computer_player.h"
#include "foosball/match.h"

namespace foosball {
namespace {

// The hash of a match of two computer players after 20,000 ticks: the same for every compiler and
// optimization level. It changes with any number of the game and with the engine's arithmetic. Then
// replace it, after g++ and clang++, Debug and Release agree on the new one.
constexpr std::uint64_t kGolden = 0xc56a1f3d619a3515u;
// The same for players with levels.
constexpr std::uint64_t kGoldenLevel = 0xf4bd3ba5742207d8u;

struct Players {
  explicit Players(std::uint64_t seed, const char* player = "classic:0.9")
      : home({.team = 0, .seed = 2 * seed, .player = *parse_player(player)}),
        away({.team = 1, .seed = 2 * seed + 1, .player = *parse_player(player)}) {}
  void play(const Match& match, RodTargets& rods) {
    home.play(match.view(), rods);
    away.play(match.view(), rods);
  }
  ComputerPlayer home, away;
};

Match new_match(std::uint64_t seed, Layout layout = Layout::tournament) {
  MatchDesc desc;
  desc.layout = layout;
  desc.seed = seed;
  return *Match::create(desc);
}

struct Golden {
  const char* player;
  std::uint64_t hash;
};
class GoldenReplay : public testing::TestWithParam<Golden> {};
INSTANTIATE_TEST_SUITE_P(Players, GoldenReplay,
                         testing::Values(Golden{"classic:0.9", kGolden},
                                         Golden{"4", kGoldenLevel}));

TEST_P(GoldenReplay, TwentyThousandTicksOfTwoComputerPlayersHaveTheGoldenHash) {
  Match match = new_match(1);
  Players players(1, GetParam().player);
  TickInput input;
  for (int tick = 0; tick < 20000; ++tick) {
    players.play(match, input.rods);
    match.step(input);
  }
  std::printf("state hash 0x%016llx, score %d:%d\n",
              static_cast<unsigned long long>(match.state_hash()), match.view().score[0],
              match.view().score[1]);
  EXPECT_EQ(match.state_hash(), GetParam().hash);
}

// Inputs alone reproduce a match. Saved and restored in the middle, it ends in the same state.
TEST(Replay, NeedsOnlyTheInputsAlsoFromASaveInTheMiddle) {
  constexpr int kTicks = 8000, kMiddle = 3500;
  Match live = new_match(5, Layout::paper);
  Players players(5);
  std::vector<RodTargets> inputs;
  std::vector<std::byte> saved;
  for (int tick = 0; tick < kTicks; ++tick) {
    if (tick == kMiddle) live.snapshot(saved);
    TickInput input;
    players.play(live, input.rods);
    inputs.push_back(input.rods);
    live.step(input);
  }
  Match replayed = new_match(5, Layout::paper);
  Match restored = new_match(5, Layout::paper);
  ASSERT_TRUE(restored.restore(saved));
  for (int tick = 0; tick < kTicks; ++tick) {
    const TickInput input{inputs[tick], {}};
    replayed.step(input);
    if (tick >= kMiddle) restored.step(input);
  }
  EXPECT_EQ(replayed.state_hash(), live.state_hash());
  EXPECT_EQ(restored.state_hash(), live.state_hash());
  EXPECT_EQ(restored.view().ball_position, live.view().ball_position);
}

TEST(Restore, RefusesForeignAndTruncatedBytesAndLeavesTheMatchAsItWas) {
  Match match = new_match(1);
  Players players(1);
  TickInput input;
  for (int tick = 0; tick < 4000; ++tick) {
    players.play(match, input.rods);
    match.step(input);
  }
  const std::uint64_t hash = match.state_hash();
  std::vector<std::byte> bytes;
  match.snapshot(bytes);
  const auto refused = [&](std::span<const std::byte> b) {
    const auto result = match.restore(b);
    return !result && result.error().code == vp::Errc::bad_data && match.state_hash() == hash;
  };
  EXPECT_TRUE(refused({}));
  for (std::size_t size = 0; size < bytes.size(); size += 1 + size / 64) {
    ASSERT_TRUE(refused(std::span(bytes).first(size))) << size;
  }
  auto longer = bytes;
  longer.push_back(std::byte{0});
  EXPECT_TRUE(refused(longer));
  const Match other_table = new_match(1, Layout::paper);
  std::vector<std::byte> other;
  other_table.snapshot(other);
  EXPECT_TRUE(refused(other));
  ASSERT_TRUE(match.restore(bytes));
  EXPECT_EQ(match.state_hash(), hash);
}

// For any flipped bit: rejected, or a match that plays on without error. SF_FLIPPED_EVERY=N: every
// N-th bit; an odd number covers all bits of a byte.
TEST(Restore, SurvivesFlippedBits) {
  const char* wanted = std::getenv("SF_FLIPPED_EVERY");
  const std::size_t every = wanted != nullptr ? std::max(1, std::atoi(wanted)) : 37;
  Match match = new_match(2);
  Players players(2);
  TickInput input;
  for (int tick = 0; tick < 3000; ++tick) {
    players.play(match, input.rods);
    match.step(input);
  }
  std::vector<std::byte> bytes;
  match.snapshot(bytes);
  int accepted = 0;
  for (std::size_t bit = 0; bit < 8 * bytes.size(); bit += every) {
    auto flipped = bytes;
    flipped[bit / 8] ^= std::byte{1} << (bit % 8);
    Match other = new_match(2);
    if (!other.restore(flipped)) continue;
    ++accepted;
    for (int tick = 0; tick < 3; ++tick) other.step(input);
    ASSERT_TRUE(std::isfinite(other.view().ball_position.x)) << bit;
  }
  std::printf("%d of %zu flipped saves were matches all the same\n", accepted,
              bytes.size() * 8 / every);
}

// Forged numbers at every offset of a saved match: rejected, or a match that plays on, whose stops
// end in time and whose snapshots can be restored.
TEST(Restore, OfAnyNumberInAnyPlaceIsRefusedOrPlaysOn) {
  Match match = new_match(2);
  const std::vector<Command> start{
      {Command::Kind::push, 0}, {Command::Kind::push, 0}, {Command::Kind::push, 1}};
  match.step({{}, start});
  const Command time_out{Command::Kind::time_out, 0};
  TickInput input;
  input.commands = std::span(&time_out, 1);
  match.step(input);
  ASSERT_GT(match.view().time_out_seconds, 0.0);
  std::vector<std::byte> bytes;
  match.snapshot(bytes);
  constexpr std::size_t kHead = 1800;  // followed by the world, which the engine tests
  ASSERT_GT(bytes.size(), kHead);
  const auto limit = match.view().time_out_seconds;
  int accepted = 0;
  for (std::size_t at = 0; at < kHead; ++at) {
    for (const std::uint64_t value :
         {std::uint64_t{0xFF}, std::uint64_t{1} << 20, std::uint64_t{1} << 40,
          ~std::uint64_t{0} >> 1, ~std::uint64_t{0}}) {
      auto forged = bytes;
      const int size = value == 0xFF ? 1 : 8;
      for (int i = 0; i < size; ++i) forged[at + i] = static_cast<std::byte>(value >> (8 * i));
      Match other = new_match(2);
      if (!other.restore(forged)) continue;
      ++accepted;
      ASSERT_LE(other.view().time_out_seconds, limit) << at;
      other.step({});
      std::vector<std::byte> again;
      other.snapshot(again);
      Match third = new_match(2);
      ASSERT_TRUE(third.restore(again)) << at << " " << value;
      ASSERT_EQ(third.state_hash(), other.state_hash()) << at;
    }
  }
  std::printf("%d of %zu forged saves were matches all the same\n", accepted, 5 * kHead);
}

// Each tick count for which a match waits, at its maximum: the ball is served in time.
TEST(Restore, OfAnyWaitEndsInTime) {
  const Rules rules{};
  const auto longest = std::uint64_t{1} << 46;
  const std::vector<std::function<void(MatchState&)>> changes{
      [&](MatchState& s) { s.serve_in = longest; },
      [&](MatchState& s) { s.serve_waits = longest; },
      [&](MatchState& s) { s.review_ticks = longest; },
      [&](MatchState& s) { s.time_out_left = longest; },
      [&](MatchState& s) { s.time_out_left = ticks_of(rules.time_out_seconds) + 1; },
      [&](MatchState& s) { s.tick = 2 * kMaxTicks; },
      [&](MatchState& s) { s.screen_ticks = s.tick + 1; },
      [&](MatchState& s) { s.play_ticks = s.tick + 1; },
      [&](MatchState& s) { s.tally.set_ticks = s.play_ticks + 1; },
      [&](MatchState& s) { s.tally.sets[0] = rules.sets_to_win; },
      [&](MatchState& s) { s.tally.time_outs[1] = rules.time_outs + 1; },
      [&](MatchState& s) { s.touch.tick = s.tick + 1; },
      [&](MatchState& s) { s.touched = ~std::uint64_t{0}; },
      [&](MatchState& s) { s.serve_man = 4, s.serve_rod = 0; },
      [&](MatchState& s) { s.ball_in_play = s.ball_parked = true; },
      [&](MatchState& s) { s.ball_in_play = true, s.ball_parked = false, s.screen = Screen::logo; },
      [&](MatchState& s) { s.paused = true, s.screen = Screen::logo; },
  };
  const MatchDesc desc{.seed = 2, .rules = rules};
  Match match = *Match::create(desc);
  const std::vector<Command> start{
      {Command::Kind::push, 0}, {Command::Kind::push, 0}, {Command::Kind::push, 1}};
  match.step({{}, start});
  std::vector<std::byte> bytes;
  match.snapshot(bytes);
  for (std::size_t i = 0; i < changes.size(); ++i) {
    MatchState state;
    auto world = std::make_unique<TableWorld>(desc.layout, bodies_of(desc, state), state.first);
    ASSERT_TRUE(load_match(desc, bytes, state, world));
    changes[i](state);
    std::vector<std::byte> forged;
    save_match(desc, state, *world, forged);
    EXPECT_FALSE(match.restore(forged)) << i;
  }
}

TEST(ComputerPlayer, IsDeterministicAndItsSeedMatters) {
  const auto hash_of = [](std::uint64_t seed) {
    Match match = new_match(9);
    Players players(seed);
    TickInput input;
    for (int tick = 0; tick < 6000; ++tick) {
      players.play(match, input.rods);
      match.step(input);
    }
    return match.state_hash();
  };
  EXPECT_EQ(hash_of(4), hash_of(4));
  EXPECT_NE(hash_of(4), hash_of(5));
}

TEST(ComputerPlayer, MovesOnlyItsOwnRodsWithAHandsSpeedsAndNeverSpins) {
  Match match = new_match(6);
  Players players(6, "classic:1");
  TickInput input;
  RodTargets before = input.rods;
  double slide_rate = 0.0, angle_rate = 0.0, swing_in_play = 0.0;
  for (int tick = 0; tick < 15000; ++tick) {
    RodTargets only_home = before;
    players.home.play(match.view(), only_home);
    for (int rod = 0; rod < kRods; ++rod) {
      if (table_spec(Layout::tournament).rods[rod].team == 1) {
        ASSERT_EQ(only_home[rod].slide, before[rod].slide);
        ASSERT_EQ(only_home[rod].live, before[rod].live);
      }
    }
    input.rods = only_home;
    players.away.play(match.view(), input.rods);
    match.step(input);
    for (int rod = 0; rod < kRods; ++rod) {
      slide_rate =
          std::max(slide_rate, std::fabs(input.rods[rod].slide - before[rod].slide) / kTick);
      angle_rate =
          std::max(angle_rate, std::fabs(input.rods[rod].angle - before[rod].angle) / kTick);
      if (match.view().ball_in_play) {
        const double turn = std::remainder(input.rods[rod].angle, 2.0 * vp::kPi);
        swing_in_play = std::max(swing_in_play, std::fabs(turn));
      }
    }
    before = input.rods;
  }
  std::printf("at most %.2f m/s, %.0f rad/s, %.2f rad from hanging\n", slide_rate, angle_rate,
              swing_in_play);
  EXPECT_LT(slide_rate, 3.0);
  EXPECT_LT(angle_rate, 140.0);
  EXPECT_LT(swing_in_play, 0.9 * vp::kPi) << "no rod ever goes over the top";
}

TEST(ComputerPlayer, StartsAMatchFromTheLogoByItself) {
  Match match = new_match(8);
  Players players(8);
  TickInput input;
  int tick = 0;
  for (; tick < 8000 && !match.view().ball_in_play; ++tick) {
    players.play(match, input.rods);
    match.step(input);
  }
  std::printf("ball in play after %.2f s\n", tick * kTick);
  EXPECT_TRUE(match.view().ball_in_play);
  EXPECT_TRUE(match.view().confirmed[0] && match.view().confirmed[1]);
}

TEST(ComputerPlayer, ThePlayerItIsHandedTheRodsByTakesOverWithoutAJump) {
  Match match = new_match(8);
  TickInput input;
  for (RodTarget& rod : input.rods) rod = {0.05, 9.0, 0.0, 0.0, true};
  for (int tick = 0; tick < 500; ++tick) match.step(input);
  Players players(8);
  for (int tick = 0; tick < 10; ++tick) {
    const RodTargets before = input.rods;
    players.play(match, input.rods);
    match.step(input);
    for (int rod = 0; rod < kRods; ++rod) {
      EXPECT_NEAR(input.rods[rod].slide, before[rod].slide, 0.004);
      EXPECT_NEAR(input.rods[rod].angle, before[rod].angle, 0.02);
    }
  }
}

}  // namespace
}  // namespace foosball
