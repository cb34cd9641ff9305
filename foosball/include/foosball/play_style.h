// Levels and styles of computer players, as the game shows them to a person.
#pragma once

#include <cstdint>

namespace foosball {

// What a computer player prefers.
enum class PlayStyle : std::uint8_t {
  wall,     // hands stay near the goal; avoids shots that may come back
  shooter,  // strikes at the first reasonable chance, from any rod
  passer,   // passes to a man further ahead where others would shoot
  gambler,  // waits for a good chance, feints, takes risks at its own goal
};
inline constexpr int kPlayStyles = 4;
const char* name_of(PlayStyle style);

inline constexpr int kLevels = 5;
PlayStyle style_of_level(int level);  // Precondition: 1 <= level <= kLevels.

// Level of the opponent at a rung of the ladder, 0 <= rung < kLadderRungs (foosball/rules.h).
constexpr int level_of_rung(int rung) {
  return rung + 1;
}

}  // namespace foosball
