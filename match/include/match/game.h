// One game between two players, from the first serve until a team has won or the time is over,
// simulated as fast as possible. Pure: the same desc gives the same result, bit for bit, on every
// machine.
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
  std::array<int, foosball::kTeams> characters{1, 1};  // by team: index in that list
  foosball::Layout layout = foosball::Layout::tournament;
  std::uint64_t seed = 1;             // of the match and of both players
  int variant = 0;                    // selects different player seeds: 0; 1 with exchanged sides
  std::uint64_t max_ticks = 600'000;  // limit of ticks; then the leader wins
  foosball::Tuning tuning{};          // must be in its ranges
  bool operator==(const GameDesc&) const = default;
};

struct GameResult {
  int winner = -1;  // team; -1: drawn at the time limit
  std::array<int, foosball::kTeams> score{};
  std::uint64_t state_hash = 0;  // final
  foosball::Statistics statistics;
  bool operator==(const GameResult&) const = default;

  // Points of the team in halves: 0 lost, 1 drawn, 2 won.
  int half_points(int team) const { return winner < 0 ? 1 : winner == team ? 2 : 0; }
};

enum class Recording { off, on };

struct PlayedGame {
  GameResult result;
  std::vector<std::byte> journal;  // a file for foosball-replay; empty if off
};

// Preconditions: make_player() accepts the players, foosball::in_range() accepts the list, and the
// characters are in it.
PlayedGame play_game(const GameDesc& desc, Recording recording = Recording::off);

// Draws two of this number of characters from the seed, the same for every player.
std::array<int, foosball::kTeams> drawn_characters(std::uint64_t seed, std::size_t characters);

// Decorrelates the seeds of neighbouring numbers (SplitMix64, Steele 2014).
std::uint64_t mix_seed(std::uint64_t value);

}  // namespace match
