// The levels of computer players and what each of them prefers: what a person is told of an
// opponent.
#pragma once

#include <cstdint>

namespace foosball {

// What a computer player prefers where it has a choice.
enum class PlayStyle : std::uint8_t {
  wall,     // hands stay at the goal, fears what comes back
  shooter,  // strikes at the first fair chance, from any rod
  passer,   // plays to a man further ahead where another would shoot
  gambler,  // waits for the one chance, feints, takes risks with its own goal
};
inline constexpr int kPlayStyles = 4;
const char* name_of(PlayStyle style);

inline constexpr int kLevels = 5;
PlayStyle style_of_level(int level);  // precondition: 1 <= level <= kLevels

// The opponent at a rung of the ladder, 0 <= rung < kLadderRungs (foosball/rules.h).
constexpr int level_of_rung(int rung) {
  return rung + 1;
}

}  // namespace foosball
