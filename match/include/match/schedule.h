// Assigns games and collects their results, for threads and ranks alike. Use from one thread at a
// time.
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

  // Appends series.
  void add(std::vector<SeriesDesc> series);

  // Supplies a result of an earlier run instead of playing the game. Ignored if its series does not
  // exist.
  void know(JobId id, const GameResult& result);

  // The next game to play; none if every game that may still be needed is in progress. After
  // give_back() it assigns a game again.
  std::optional<JobId> next();
  // Accepts results in any order; each series receives its results in order. Returns false and
  // ignores the result if the game was already completed by a player who was believed lost.
  bool complete(JobId id, const GameResult& result);
  // The game's player is lost: the game can be assigned again.
  void give_back(JobId id);

  bool finished() const;
  GameDesc game(JobId id) const { return series_[id.series].game(id.game); }
  const std::vector<Series>& series() const { return series_; }
  std::uint64_t games_taken() const;
  std::uint64_t games_at_most() const;  // all games of undecided series, counted ones of others

 private:
  void take_known(std::size_t series);

  std::vector<Series> series_;
  std::vector<std::uint64_t> handed_out_;  // by series: number of games assigned so far
  std::map<JobId, GameResult> waiting_;    // results that wait for earlier games
  std::vector<JobId> returned_;
  std::set<JobId> uncounted_;  // games beyond the point at which their series was decided
};

}  // namespace match
