// A ball that nobody can reach is freed by rule, whoever plays: computers, an absent side, rods
// that spin, rods held aside. The runner's report has the same figure for any number of matches.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdio>

#include "bodies.h"
#include "foosball/computer_player.h"
#include "foosball/match.h"
#include "foosball/reach.h"

namespace foosball {
namespace {

enum class Side { computer, absent, aside, spins };

struct Longest {
  std::uint64_t unreachable = 0;  // ticks at a stretch, out of everybody's reach
  std::uint64_t held = 0;         // within one rod's reach
};

void move(Side side, int team, const MatchView& view, ComputerPlayer& computer, RodTargets& rods) {
  if (side == Side::computer) return computer.play(view, rods);
  for (const int rod : rods_of_team(table_spec(view.layout), team)) {
    rods[rod].live = true;
    if (side == Side::aside) rods[rod].angle = 1.5;
    if (side == Side::spins) rods[rod].angle += 0.03;
  }
}

Longest play(const MatchDesc& desc, Side home, Side away, int ticks) {
  Match match = *Match::create(desc);
  ComputerPlayer first({.team = 0, .seed = 2 * desc.seed, .player = *parse_player("classic:0.9")});
  ComputerPlayer second(
      {.team = 1, .seed = 2 * desc.seed + 1, .player = *parse_player("classic:0.9")});
  const Command confirm[] = {{Command::Kind::push, 0, 0}, {Command::Kind::push, 1, 0}};
  const TableSpec& table = table_spec(desc.layout);
  TickInput input;
  Longest longest;
  std::uint64_t unreachable = 0, held = 0;
  std::uint8_t held_by = 0;
  for (int tick = 0; tick < ticks; ++tick) {
    input.commands = {};
    if (match.view().screen < Screen::play) input.commands = confirm;
    move(home, 0, match.view(), first, input.rods);
    move(away, 1, match.view(), second, input.rods);
    match.step(input);
    const MatchView& view = match.view();
    if (!view.ball_in_play) {
      unreachable = held = 0;
      continue;
    }
    const auto rods = rods_in_reach(table, view.bodies, view.ball_position);
    unreachable = rods == 0 ? unreachable + 1 : 0;
    held = rods != 0 && rods == held_by ? held + 1 : 0;
    held_by = rods;
    longest.unreachable = std::max(longest.unreachable, unreachable);
    longest.held = std::max(longest.held, held);
  }
  return longest;
}

TEST(StuckBall, NoneIsOutOfReachOrHeldForLongerThanTheRulesAllow) {
  Longest longest;
  for (const Layout layout : {Layout::paper, Layout::tournament}) {
    for (const auto& rules : {arcade_rules(), itsf_rules(1)}) {
      for (const Side away : {Side::computer, Side::absent, Side::aside, Side::spins}) {
        for (const Side home : {Side::computer, Side::aside}) {
          for (std::uint64_t seed = 1; seed <= 1; ++seed) {
            MatchDesc desc{.layout = layout, .seed = seed, .rules = rules};
            desc.rules.idle_seconds = 0.0;
            const Longest here = play(desc, home, away, 45'000);
            longest.unreachable = std::max(longest.unreachable, here.unreachable);
            longest.held = std::max(longest.held, here.held);
          }
        }
      }
    }
  }
  std::printf("out of reach for %.3f s at most, held for %.3f s\n",
              static_cast<double>(longest.unreachable) * kTick,
              static_cast<double>(longest.held) * kTick);
  EXPECT_LE(static_cast<double>(longest.unreachable) * kTick, Rules{}.dead_ball_seconds);
  EXPECT_LE(static_cast<double>(longest.held) * kTick, Rules{}.possession_seconds);
}

}  // namespace
}  // namespace foosball
