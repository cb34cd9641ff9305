// The styles of computer players differ in their statistics.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdio>
#include <utility>

#include "foosball/computer_player.h"
#include "foosball/statistics.h"

namespace foosball {
namespace {

// Four minutes of one style on each side against level 4, so that the side does not matter.
Statistics minutes_of(const char* name, Layout layout) {
  Statistics sum;
  for (int team = 0; team < kTeams; ++team) {
    Match match = *Match::create({.layout = layout, .seed = 11, .rules = {}});
    ComputerPlayer own({.team = team, .seed = 21, .player = *parse_player(name)});
    ComputerPlayer other({.team = 1 - team, .seed = 22, .player = *parse_player("4")});
    StatisticsObserver one;
    TickInput input;
    for (int tick = 0; tick < 240000; ++tick) {
      own.play(match.view(), input.rods);
      other.play(match.view(), input.rods);
      match.step(input);
      one.meant(own.passed(), layout);
      one.observe(match.view(), match.events(), input.rods);
    }
    Statistics s = one.totals();
    if (team == 1) {  // count it as team 0
      std::swap(s.shots[0], s.shots[1]);
      std::swap(s.passes_meant[0], s.passes_meant[1]);
      std::swap(s.passes_arrived[0], s.passes_arrived[1]);
      std::reverse(s.hand_ticks.begin(), s.hand_ticks.end());
    }
    sum.merge(s);
  }
  return sum;
}

// Rods 0 and 1 are the goalie and the defence of team 0.
double share_at_home(const Statistics& s) {
  double home = 0.0, all = 0.0;
  for (int rod = 0; rod < kRods; ++rod) {
    if (table_spec(Layout::tournament).rods[rod].team != 0) continue;
    all += static_cast<double>(s.hand_ticks[rod]);
    if (rod < 2) home += static_cast<double>(s.hand_ticks[rod]);
  }
  return home / all;
}

TEST(PlayStyles, DifferInWhatTheyDo) {
  const auto play = [](const char* name) { return minutes_of(name, Layout::tournament); };
  const Statistics wall = play("5:wall"), shooter = play("5:shooter"), passer = play("5:passer"),
                   gambler = play("5:gambler");
  const auto print = [](const char* name, const Statistics& s) {
    std::printf("%-8s shots %d, passes to a man %d, of them arrived %d, hands at home %.2f\n", name,
                static_cast<int>(s.shots[0]), static_cast<int>(s.passes_meant[0]),
                static_cast<int>(s.passes_arrived[0]), share_at_home(s));
  };
  print("wall", wall);
  print("shooter", shooter);
  print("passer", passer);
  print("gambler", gambler);
  const auto shots = [](const Statistics& s) {
    return static_cast<double>(s.shots[0]) / static_cast<double>(s.play_ticks);
  };
  EXPECT_GT(shots(shooter), 1.1 * shots(gambler));
  EXPECT_GT(passer.passes_meant[0], 2 * shooter.passes_meant[0]);
  EXPECT_GT(passer.passes_meant[0], 2 * gambler.passes_meant[0]);
  EXPECT_GT(passer.passes_meant[0], wall.passes_meant[0]);
  EXPECT_GE(passer.passes_arrived[0], 1U);
  EXPECT_GT(share_at_home(wall), share_at_home(gambler) + 0.03);
  EXPECT_GT(share_at_home(wall), share_at_home(shooter) + 0.03);
}

}  // namespace
}  // namespace foosball
