// Elo of players from their games against each other: the maximum of the Bradley-Terry likelihood,
// a drawn game being half a win and half a loss, with the mean of all players at 0.
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
      0.0;  // standard error, from the curvature of the likelihood and the pairs' variance
};

// Each encounter counts half a drawn pair more than it had, so that whoever won all his games has a
// finite rating. Preconditions: first, second < players; every player has met the others, directly
// or over third ones.
std::vector<Rating> rate(std::size_t players, const std::vector<Encounter>& encounters);

}  // namespace match
