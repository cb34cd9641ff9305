// Elo ratings, computed from the results on request. They are not stored, so that they always agree
// with the stored matches.
//
// Source: A. Elo, The Rating of Chessplayers (1978). The rating of a team is the mean of its
// players'. Its expected score against another is E = 1 / (1 + 10^((R_other - R_own) / 400)). Each
// of its players gains K (S - E), S = 1 for a win, 0 for a defeat. The mean is weighted by each
// player's fraction of the match.
#pragma once

#include <algorithm>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "results/match_result.h"

namespace results {

inline constexpr double kFirstRating = 1500.0;
inline constexpr double kRatingGain = 32.0;  // K: between equal teams, half of it changes hands
// A match counts only for players whose absence was at most this fraction: play by the computer in
// place of an absent person does not count for that person. A player who left has lost the match,
// whatever the team's result: leaving saves no rating, and the play of others gains none.
inline constexpr double kLargestAbsence = 0.1;
inline bool played(const Player& player) {
  return player.share >= 1.0 - kLargestAbsence && !player.left;
}
inline bool counts_for(const Player& player) {
  return played(player) || player.left;
}

struct Standing {
  std::string name, kind;  // kind: in the last match
  double rating = kFirstRating;
  std::uint64_t matches = 0, wins = 0, losses = 0;  // that count for the player
  std::uint64_t not_counted = 0;  // other matches: the player's fraction was too small
  std::uint64_t goals_for = 0, goals_against = 0;  // of the player's team
  double fastest_shot = 0.0;                       // by the player's team [m/s]; 0: not known
  // Of the player's team: opponents' shots on target, and those that it saved.
  std::uint64_t shots_faced = 0, saves = 0;
  std::optional<double> saved() const {  // fraction of shots_faced, 0 .. 1; none: no shots faced
    if (shots_faced == 0) return std::nullopt;
    return std::min(1.0, static_cast<double>(saves) / static_cast<double>(shots_faced));
  }
  bool operator==(const Standing&) const = default;
};

// Standings of all players, best first; ties by name. matches: in the order of play. A drawn match
// counts, but changes no rating (except a leaver's). The same holds for a match of a player against
// themselves.
std::vector<Standing> standings(std::span<const MatchResult> matches);

// Mean rating of the team's players who have played the match, or of all if none has.
double rating_of(const Team& team, std::span<const Standing> standings);

}  // namespace results
