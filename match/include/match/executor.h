// Plays the games of a schedule on threads of this machine.
#pragma once

#include <atomic>
#include <functional>
#include <string>
#include <tl/expected.hpp>

#include "match/checkpoint.h"
#include "match/schedule.h"

namespace match {

struct Effort {
  std::uint64_t games = 0, ticks = 0;  // played by this run, including uncounted games
  double core_seconds = 0.0;           // processor time of the playing threads
  double seconds = 0.0;                // elapsed time
  double real_time_factor() const {
    const double simulated = static_cast<double>(ticks) * foosball::kTick;
    return core_seconds > 0.0 ? simulated / core_seconds : 0.0;
  }
};

struct ExecutorOptions {
  int jobs = 1;
  std::string record_folder;         // folder for a journal of each game; empty: none
  Checkpoint* checkpoint = nullptr;  // stores each result on arrival
  // Called for each new result on arrival, one at a time: for additional storage.
  std::function<void(const GameDesc&, JobId, const GameResult&)> taken;
  const std::atomic<bool>* stop = nullptr;  // true: starts no new games; games in progress finish
  std::function<void(const Schedule&, const Effort&)> progress;  // after each game, one at a time
};

// The error is a sentence: a file could not be written.
tl::expected<Effort, std::string> play_all(Schedule& schedule, const ExecutorOptions& options);

// Passes a finished game to the schedule, the checkpoint and options.taken, unless it was finished
// before. The error is a sentence: the checkpoint could not be written.
tl::expected<void, std::string> keep(Schedule& schedule, const ExecutorOptions& options, JobId id,
                                     const GameResult& result);

// Plays one game. Writes its journal if record_folder is not empty. Callable from any thread.
tl::expected<GameResult, std::string> play_job(const GameDesc& game, JobId id,
                                               const std::string& record_folder);
std::string journal_name(JobId id, const GameDesc& game);

}  // namespace match
