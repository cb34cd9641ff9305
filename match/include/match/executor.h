// Plays a schedule's games on threads of this machine.
#pragma once

#include <atomic>
#include <functional>
#include <string>
#include <tl/expected.hpp>

#include "match/checkpoint.h"
#include "match/schedule.h"

namespace match {

struct Effort {
  std::uint64_t games = 0, ticks = 0;  // played by this run, counted or not
  double core_seconds = 0.0;           // processor time of the threads that played
  double seconds = 0.0;                // on the wall
  double real_time_factor() const {
    const double simulated = static_cast<double>(ticks) * foosball::kTick;
    return core_seconds > 0.0 ? simulated / core_seconds : 0.0;
  }
};

struct ExecutorOptions {
  int jobs = 1;
  std::string record_folder;         // a journal of each game; empty: none
  Checkpoint* checkpoint = nullptr;  // takes each result as it comes
  // Each game once, as it comes, one at a time: for whoever keeps them elsewhere.
  std::function<void(const GameDesc&, JobId, const GameResult&)> taken;
  const std::atomic<bool>* stop = nullptr;  // true: no new games; those under way are finished
  std::function<void(const Schedule&, const Effort&)> progress;  // after each game, one at a time
};

// The error is a sentence: a file that could not be written.
tl::expected<Effort, std::string> play_all(Schedule& schedule, const ExecutorOptions& options);

// Hands a finished game on to the schedule, the checkpoint and options.taken; one that was finished
// before, to nobody. The error is a sentence: the checkpoint could not be written.
tl::expected<void, std::string> keep(Schedule& schedule, const ExecutorOptions& options, JobId id,
                                     const GameResult& result);

// Plays one game and writes its journal, if there is a folder for it. Any thread.
tl::expected<GameResult, std::string> play_job(const GameDesc& game, JobId id,
                                               const std::string& record_folder);
std::string journal_name(JobId id, const GameDesc& game);

}  // namespace match
