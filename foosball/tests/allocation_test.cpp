// A tick of play allocates nothing; only a change of screen may. Stands apart, since it replaces
// the global operator new.
#include <gtest/gtest.h>

#include <cstdlib>
#include <new>

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

TEST(Allocation, NoneInATickOfPlayOnceWarm) {
  Match match = *Match::create(MatchDesc{});
  ComputerPlayer home({.team = 0, .seed = 1, .player = *parse_player("5")});
  ComputerPlayer away({.team = 1, .seed = 2, .player = *parse_player("5")});
  TickInput input;
  constexpr double kWarm = 2.0;  // [s] of play: the engine's arrays have met their size
  long in_play = 0, ticks = 0;
  for (int tick = 0; tick < 60000; ++tick) {
    const bool warm = match.view().screen == Screen::play && match.view().play_seconds > kWarm;
    const Screen screen = match.view().screen;
    const long before = allocations;
    home.play(match.view(), input.rods);
    away.play(match.view(), input.rods);
    match.step(input);
    if (!warm || match.view().screen != screen) continue;
    in_play += allocations - before;
    ++ticks;
  }
  EXPECT_GT(ticks, 5000);
  EXPECT_EQ(in_play, 0);
}

}  // namespace
}  // namespace foosball
