// Follows the matches of a server, one after another, and makes a result of each that was won or
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
  // Who has played a team; asked at the end of a match.
  using Players = std::array<std::vector<results::Player>, foosball::kTeams>;

  explicit MatchScribe(const foosball::MatchDesc& match) : match_(match) {}

  // After each tick, with the targets that it was stepped with. True: the match is over, won or
  // drawn, and result() tells it. Takes no memory.
  bool observe(const foosball::Match& match, const foosball::RodTargets& targets);
  bool begins() const { return begins_; }  // a match did in that tick
  // Of the match that is just over; the date and the recording are the caller's to add.
  results::MatchResult result(const foosball::MatchView& view, const Players& players) const;

 private:
  foosball::MatchDesc match_;
  bool begins_ = false;
  std::uint32_t matches_begun_ = 0;  // as the view has them
  foosball::StatisticsObserver statistics_;
  foosball::Statistics before_;  // totals when this match began
};

}  // namespace server
