// Elo ratings, computed from results alone: never stored, so that they are always those of the
// matches that there are.
//
// Source: A. Elo, The Rating of Chessplayers (1978). A team is rated by the mean of its players;
// its expected score against another is E = 1 / (1 + 10^((R_other - R_own) / 400)), and each of its
// players gains K (S - E), S = 1 for a win, 0 for a defeat.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "results/match_result.h"

namespace results {

inline constexpr double kFirstRating = 1500.0;
inline constexpr double kRatingGain = 32.0;  // K: half of it goes over where equals meet

struct Standing {
  std::string name, kind;  // kind: as in the last match
  double rating = kFirstRating;
  std::uint64_t matches = 0, wins = 0, losses = 0;
  std::uint64_t goals_for = 0, goals_against = 0;  // of his team
  double fastest_shot = 0.0;  // in a match of his, of either team [m/s]; 0: not known
  bool operator==(const Standing&) const = default;
};

// Of all players, best first; equals by name. Matches in the order in which they were played; one
// that nobody has won counts, but moves no rating, and so does one in which a player met himself.
std::vector<Standing> standings(std::span<const MatchResult> matches);

}  // namespace results
