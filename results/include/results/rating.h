// Elo ratings, computed from results alone: never stored, so that they are always those of the
// matches that there are.
//
// Source: A. Elo, The Rating of Chessplayers (1978). A team is rated by the mean of its players;
// its expected score against another is E = 1 / (1 + 10^((R_other - R_own) / 400)), and each of its
// players gains K (S - E), S = 1 for a win, 0 for a defeat. The mean is weighted by how much of the
// match each has played.
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
inline constexpr double kRatingGain = 32.0;  // K: half of it goes over where equals meet
// A match counts for who has played all of it but so much: what the computer did for somebody who
// was away is not that person's. Whoever has left it has lost it, whatever the team has done since:
// no rating is saved by leaving, and none is won by others' play.
inline constexpr double kLargestAbsence = 0.1;
inline bool played(const Player& player) {
  return player.share >= 1.0 - kLargestAbsence && !player.left;
}
inline bool counts_for(const Player& player) {
  return played(player) || player.left;
}

struct Standing {
  std::string name, kind;  // kind: as in the last match
  double rating = kFirstRating;
  std::uint64_t matches = 0, wins = 0, losses = 0;  // that count for him
  std::uint64_t not_counted = 0;                    // others: he played too little of them
  std::uint64_t goals_for = 0, goals_against = 0;   // of his team
  double fastest_shot = 0.0;  // of his team in a match of his [m/s]; 0: not known
  // Of his team: shots of the others that would have been goals, and those that it saved.
  std::uint64_t shots_faced = 0, saves = 0;
  std::optional<double> saved() const {  // share of shots_faced, 0 .. 1; none: it faced none
    if (shots_faced == 0) return std::nullopt;
    return std::min(1.0, static_cast<double>(saves) / static_cast<double>(shots_faced));
  }
  bool operator==(const Standing&) const = default;
};

// Of all players, best first; equals by name. Matches in the order in which they were played; one
// that nobody has won counts, but moves no rating (but a leaver's), and so does one in which a
// player met himself.
std::vector<Standing> standings(std::span<const MatchResult> matches);

// Of those of the team who have played the match, or of all if none has: their mean.
double rating_of(const Team& team, std::span<const Standing> standings);

}  // namespace results
