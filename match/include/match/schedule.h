// Which game is to be played next, and what becomes of the results: for threads and ranks alike.
// Used by one thread at a time.
#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <optional>
#include <set>
#include <vector>

#include "match/series.h"

namespace match {

struct JobId {
  std::size_t series = 0;
  std::uint64_t game = 0;
  auto operator<=>(const JobId&) const = default;
};

class Schedule {
 public:
  explicit Schedule(std::vector<SeriesDesc> series) { add(std::move(series)); }

  // More series, after those that are there.
  void add(std::vector<SeriesDesc> series);

  // Results of an earlier run: are taken instead of played. Ignored if they are of no series here.
  void know(JobId id, const GameResult& result);

  // The next game to play; nothing, if all that may still be needed is under way. Gives a game
  // again after give_back().
  std::optional<JobId> next();
  // Takes results in any order; each series sees them in its own. False: this game was played
  // before, by another who was thought lost, and nothing is taken.
  bool complete(JobId id, const GameResult& result);
  // Whoever played it is gone.
  void give_back(JobId id);

  bool finished() const;
  GameDesc game(JobId id) const { return series_[id.series].game(id.game); }
  const std::vector<Series>& series() const { return series_; }
  std::uint64_t games_taken() const;
  std::uint64_t games_at_most() const;  // of those not decided all, else those taken

 private:
  void take_known(std::size_t series);

  std::vector<Series> series_;
  std::vector<std::uint64_t> handed_out_;  // by series: games below this
  std::map<JobId, GameResult> waiting_;    // for those before them
  std::vector<JobId> returned_;
  std::set<JobId> uncounted_;  // played beyond the point where their series was decided
};

}  // namespace match
