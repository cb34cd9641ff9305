// A tick of play does not allocate; only a change of screen or of the tuning may. In a program of
// its own, because it replaces the global operator new.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <new>
#include <vector>

#include "../src/table_world.h"
#include "foosball/computer_player.h"
#include "foosball/match.h"

namespace {
long allocations = 0;
}

void* operator new(std::size_t size) {
  ++allocations;
  if (void* p = std::malloc(size)) return p;
  throw std::bad_alloc();
}
void operator delete(void* p) noexcept {
  std::free(p);
}
void operator delete(void* p, std::size_t) noexcept {
  std::free(p);
}

namespace foosball {
namespace {

// Allocations in ticks of play, by the latest event.
struct Taken {
  long in_play = 0;       // undisturbed play, total
  long at_tuning = 0;     // maximum per tick: the match rebuilds its world
  long after_tuning = 0;  // maximum per tick in which a player rebuilds its own worlds
  long whole_worlds = 0;  // total of those ticks
  long by_stand_in = 0;   // a third player joins, leaves and rejoins, total
  int tuned = 0, stood_in = 0;
};

// Longer than a player takes to build its two worlds.
constexpr int kMaking = 2 * (2 + TableWorld::kParts);

Taken play(const char* player) {
  Match match = *Match::create(MatchDesc{});
  ComputerPlayer home({.team = 0, .seed = 1, .player = *parse_player(player)});
  ComputerPlayer mate({.team = 0, .seed = 3, .player = *parse_player(player)});
  ComputerPlayer away({.team = 1, .seed = 2, .player = *parse_player(player)});
  constexpr std::uint8_t kMates = 0x0F;
  std::vector<Command> commands;
  commands.reserve(1);
  TickInput input;
  Taken taken;
  int since_tuning = 1000;
  for (int tick = 0, warm = 0; tick < 60'000; ++tick) {
    const Screen screen = match.view().screen;
    // The engine's arrays have reached their size.
    warm = screen == Screen::play && match.view().play_seconds > 2.0 ? warm + 1 : 0;
    commands.clear();
    ++since_tuning;
    if (warm > 0 && warm % 4'000 == 0) {
      const double gravity = match.view().tuning.gravity > 12.0 ? 12.0 : 12.5;
      commands.push_back(
          {Command::Kind::tune, 0, static_cast<std::uint8_t>(tuning_index("gravity")), gravity});
      since_tuning = 0;
      ++taken.tuned;
    }
    input.commands = commands;
    const std::uint8_t mates = warm % 1'000 > 500 ? kMates : 0;
    const bool changes = warm % 1'000 == 501 || warm % 1'000 == 0;
    taken.stood_in += warm > 0 && changes ? 1 : 0;
    const long before = allocations;
    home.play(match.view(), input.rods, static_cast<std::uint8_t>(~mates));
    mate.play(match.view(), input.rods, mates);
    away.play(match.view(), input.rods);
    match.step(input);
    const long now = allocations - before;
    if (warm == 0 || match.view().screen != screen) continue;
    if (since_tuning == 0) {
      taken.at_tuning = std::max(taken.at_tuning, now);
    } else if (since_tuning <= kMaking) {
      taken.after_tuning = std::max(taken.after_tuning, now);
      taken.whole_worlds += now;
    } else if (since_tuning > 300) {  // the new worlds' arrays have reached their size
      (changes ? taken.by_stand_in : taken.in_play) += now;
    }
  }
  std::printf("%s: a tick that tunes takes %ld allocations, one after it up to %ld\n", player,
              taken.at_tuning, taken.after_tuning);
  return taken;
}

// Level 5 has worlds of its own.
TEST(Allocation, NoneInATickOfPlayNorWhenAPlayerTakesRodsOver) {
  for (const char* player : {"5", "3"}) {
    const Taken taken = play(player);
    EXPECT_GT(taken.tuned, 3);
    EXPECT_GT(taken.stood_in, 20);
    EXPECT_EQ(taken.in_play, 0) << player;
    EXPECT_EQ(taken.by_stand_in, 0) << player;
  }
}

// Only a change of the tuning allocates during play: the match rebuilds its world in that tick, the
// players theirs in parts.
TEST(Allocation, AChangeOfTheTuningIsSpreadOverTicks) {
  const Taken taken = play("5");
  ASSERT_GT(taken.tuned, 3);
  EXPECT_LT(taken.after_tuning, taken.whole_worlds / taken.tuned / 8);
  const long one_world = taken.whole_worlds / taken.tuned / 6;  // two of three players
  EXPECT_LT(taken.at_tuning, one_world + one_world / 2) << "one world, the match's";
}

}  // namespace
}  // namespace foosball
