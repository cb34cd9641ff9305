// Observes the server's matches one after another, and makes a result of each that was won or
// drawn.
#pragma once

#include <array>
#include <vector>

#include "foosball/match.h"
#include "foosball/statistics.h"
#include "results/match_result.h"
#include "server/match_statistics.h"

namespace server {

class MatchScribe {
 public:
  // The players of each team; requested at the end of a match.
  using Players = std::array<std::vector<results::Player>, foosball::kTeams>;

  explicit MatchScribe(const foosball::MatchDesc& match) : match_(match) {}

  // Call after each tick, with the targets that it was stepped with. True: the match was won or
  // drawn, and result() returns its result. Does not allocate.
  bool observe(const foosball::Match& match, const foosball::RodTargets& targets);
  bool begins() const { return begins_; }  // a match began in that tick
  // The result of the match that just ended; the caller adds the date and the recording.
  results::MatchResult result(const foosball::MatchView& view, const Players& players) const;

 private:
  foosball::MatchDesc match_;
  bool begins_ = false;
  std::uint32_t matches_begun_ = 0;  // as in the view
  foosball::StatisticsObserver statistics_;
  foosball::Statistics before_;  // totals when this match began
};

}  // namespace server
