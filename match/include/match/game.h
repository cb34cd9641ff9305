// One game between two players, from the first serve until a side has won or time is over, as fast
// as it can be stepped. Pure: the same desc gives the same result, to the bit, on every machine.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "foosball/match.h"
#include "foosball/statistics.h"

namespace match {

struct GameDesc {
  std::array<std::string, foosball::kTeams> players;  // by team (match/player.h)
  foosball::Characters character_list = foosball::built_in_characters();
  std::array<int, foosball::kTeams> characters{1, 1};  // by team, of that list
  foosball::Layout layout = foosball::Layout::tournament;
  std::uint64_t seed = 1;             // of the match and of both players
  int variant = 0;                    // other seeds of the players: 0, or 1 with changed sides
  std::uint64_t max_ticks = 600'000;  // stepped; then the side that is ahead has won
  foosball::Tuning tuning{};          // in its ranges
  bool operator==(const GameDesc&) const = default;
};

struct GameResult {
  int winner = -1;  // team; -1: drawn when time was over
  std::array<int, foosball::kTeams> score{};
  std::uint64_t state_hash = 0;  // at the end
  foosball::Statistics statistics;
  bool operator==(const GameResult&) const = default;

  // Of the team: 0 lost, 1 drawn, 2 won.
  int half_points(int team) const { return winner < 0 ? 1 : winner == team ? 2 : 0; }
};

enum class Recording { off, on };

struct PlayedGame {
  GameResult result;
  std::vector<std::byte> journal;  // a file that foosball-replay verifies; empty if off
};

// Preconditions: players that make_player accepts, a list that foosball::in_range() accepts,
// characters that it has.
PlayedGame play_game(const GameDesc& desc, Recording recording = Recording::off);

// Two of so many characters drawn from the seed, the same for every player.
std::array<int, foosball::kTeams> drawn_characters(std::uint64_t seed, std::size_t characters);

// Seeds that differ in every bit from those of neighboring numbers (SplitMix64, Steele 2014).
std::uint64_t mix_seed(std::uint64_t value);

}  // namespace match
