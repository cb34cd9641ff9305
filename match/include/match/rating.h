// Elo ratings of players from their games against each other: the maximum of the Bradley-Terry
// likelihood, with the mean of all players at 0. A drawn game counts as half a win and half a loss.
// Sources: Bradley and Terry 1952 (bradley1952), Hunter 2004 (hunter2004), docs/references.bib.
#pragma once

#include <cstddef>
#include <vector>

#include "match/sequential.h"

namespace match {

struct Encounter {
  std::size_t first, second;
  PairCounts pairs;  // of the first
};

struct Rating {
  double elo = 0.0;
  double error =
      0.0;  // standard error, from the curvature of the likelihood and the variance of the pairs
};

// Each encounter gets an additional half of a drawn pair, so that a player who won all games has a
// finite rating. Preconditions: first, second < players; every player has met all others, directly
// or through other players.
std::vector<Rating> rate(std::size_t players, const std::vector<Encounter>& encounters);

}  // namespace match
