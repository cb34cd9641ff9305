// Complete matches of every level in both layouts are saved at random ticks and continue from
// there.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdio>
#include <optional>
#include <random>
#include <tuple>
#include <vector>

#include "foosball/computer_player.h"
#include "foosball/match.h"

namespace foosball {
namespace {

// From each random tick to the next, a second match restored from the snapshot runs in parallel.
class WholeMatch : public testing::TestWithParam<std::tuple<const char*, Layout>> {};
INSTANTIATE_TEST_SUITE_P(Levels, WholeMatch,
                         testing::Combine(testing::Values("1", "2", "3", "4", "5"),
                                          testing::Values(Layout::paper, Layout::tournament)));

TEST_P(WholeMatch, GoesOnFromASaveAtAnyTickToTheSameHash) {
  const auto [player, layout] = GetParam();
  MatchDesc desc{.layout = layout, .seed = 11};
  desc.rules.goals_to_win = 2;
  Match live = *Match::create(desc);
  std::optional<Match> restored;
  const PlayerSpec spec = *parse_player(player);
  ComputerPlayer home({.team = 0, .seed = 22, .player = spec});
  ComputerPlayer away({.team = 1, .seed = 23, .player = spec});
  std::mt19937 random(0x5A7E);  // the same sequence on every machine
  TickInput input;
  std::vector<std::byte> saved;
  int tick = 0, save_at = 0, saves = 0, end = 600'000;
  for (; tick < end; ++tick) {
    if (tick == save_at) {
      saved.clear();
      live.snapshot(saved);
      restored.emplace(*Match::create(desc));
      ASSERT_TRUE(restored->restore(saved)) << tick;
      ASSERT_EQ(restored->state_hash(), live.state_hash()) << tick;
      ++saves;
      save_at += 1 + static_cast<int>(random() % 12'000);
    }
    home.play(live.view(), input.rods);
    away.play(live.view(), input.rods);
    live.step(input);
    restored->step(input);
    if (tick + 1 == save_at || tick % 500 == 0) {
      ASSERT_EQ(restored->state_hash(), live.state_hash()) << tick;
    }
    for (const Event& event : live.events()) {
      if (event.kind == EventKind::match_won) end = std::min(end, tick + 3000);
    }
  }
  std::printf("%d saves in %d ticks, score %d:%d\n", saves, tick, live.view().score[0],
              live.view().score[1]);
  EXPECT_LT(tick, 600'000) << "the match was won";
  EXPECT_EQ(restored->state_hash(), live.state_hash());
}

}  // namespace
}  // namespace foosball
