// The rules free a ball that nobody can reach, for any players: computers, an absent team, rods
// that spin, rods held to the side. The runner measures the same for any number of matches of all
// levels (space-foosball-match --stuck-balls).
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdio>
#include <string>

#include "bodies.h"
#include "foosball/computer_player.h"
#include "foosball/match.h"
#include "foosball/reach.h"

namespace foosball {
namespace {

enum class Side { computer, absent, aside, spins };

struct Longest {
  std::uint64_t unreachable = 0;  // longest interval out of everybody's reach [ticks]
  std::uint64_t held = 0;         // the same within one rod's reach
};

void move(Side side, int team, const MatchView& view, ComputerPlayer& computer, RodTargets& rods) {
  if (side == Side::computer) return computer.play(view, rods);
  for (const int rod : rods_of_team(table_spec(view.layout), team)) {
    rods[rod].live = true;
    if (side == Side::aside) rods[rod].angle = 1.5;
    if (side == Side::spins) rods[rod].angle += 0.03;
  }
}

Longest play(const MatchDesc& desc, int level, Side home, Side away, int ticks) {
  Match match = *Match::create(desc);
  const PlayerSpec player = *parse_player(std::to_string(level));
  ComputerPlayer first({.team = 0, .seed = 2 * desc.seed, .player = player});
  ComputerPlayer second({.team = 1, .seed = 2 * desc.seed + 1, .player = player});
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

struct Sides {
  Side home, away;
};
constexpr Sides kSides[] = {{Side::computer, Side::computer}, {Side::computer, Side::absent},
                            {Side::computer, Side::aside},    {Side::computer, Side::spins},
                            {Side::aside, Side::computer},    {Side::aside, Side::absent},
                            {Side::aside, Side::aside},       {Side::aside, Side::spins}};

TEST(StuckBall, NoneIsOutOfReachOrHeldForLongerThanTheRulesAllow) {
  Longest longest;
  std::uint64_t seed = 0;
  for (const Layout layout : {Layout::paper, Layout::tournament}) {
    for (const auto& rules : {arcade_rules(), itsf_rules(1)}) {
      for (const Sides& sides : kSides) {
        const bool computers = sides.home == Side::computer && sides.away == Side::computer;
        // Every level against itself; against others the levels alternate.
        for (int i = 0; i < (computers ? kLevels : 1); ++i) {
          MatchDesc desc{.layout = layout, .seed = ++seed, .rules = rules};
          desc.rules.idle_seconds = 0.0;
          const int level = 1 + static_cast<int>(seed % kLevels);
          const Longest here = play(desc, level, sides.home, sides.away, 45'000);
          longest.unreachable = std::max(longest.unreachable, here.unreachable);
          longest.held = std::max(longest.held, here.held);
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
