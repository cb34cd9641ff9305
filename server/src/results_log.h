// Keeps results in their file on a thread of its own: the tick hands them on and never waits. A
// file that is damaged, locked or cannot be made stops nothing: it is told, and results wait, as
// many as there is room for, until the file takes them or the program ends.
#pragma once

#include <array>
#include <chrono>
#include <cstdint>
#include <future>
#include <memory>
#include <string>
#include <thread>
#include <vector>

#include "results/match_result.h"
#include "results/questionnaire.h"
#include "results/rating.h"
#include "wire/sentence.h"

namespace server {

struct ResultsLogOptions {
  std::string path;
  std::chrono::milliseconds retry_period{10'000};   // while results wait
  std::chrono::milliseconds close_patience{4'000};  // a locked file is given results::kBusy_ms
};

class ResultsLog {
 public:
  static constexpr std::size_t kWaiting = 64;  // results; a match takes minutes
  // For a report ratings are of so many of the newest matches, and so many of the best are named.
  static constexpr std::size_t kRated = 10'000, kFame = 8;

  explicit ResultsLog(const ResultsLogOptions& options);
  ~ResultsLog();  // closes, if close() was not called

  // Tick thread, as is answer(). False: too many are waiting, this one is lost and counted. number:
  // the caller's, for answer(); counts up.
  bool add(results::MatchResult result, std::uint32_t number = 0);
  // A player's answers after the match of that number, which they are kept with; lost and counted
  // if it was lost. Not two for one rod: the store refuses the second.
  bool answer(const results::Answers& answers, std::uint32_t number);
  // Tries once more to keep what waits, and ends the thread; within close_patience, else the thread
  // is left alone. Not for the loop while it runs.
  void close();

  // Any thread. Empty, or the sentence that says why results are not kept now.
  std::string problem() const;
  // Tick thread: it is another one than at the last call. False too while the thread is writing it.
  bool problem_changed(wire::Sentence& problem);
  // What is kept now: the last match of this run, and who plays best in all of them.
  struct Report {
    std::uint32_t number = 0;  // add()'s; 0: none yet
    results::MatchResult match;
    std::array<double, results::kTeams> rating{}, change{};  // mean of the team's players
    std::vector<results::Standing> fame;                     // best first
  };
  // Tick thread: there is another one than at the last call. False too while it is being written.
  bool report_changed(Report& report);
  std::uint64_t kept() const;     // matches
  std::uint64_t answers() const;  // kept

 private:
  class Keeper;

  std::string path_;
  std::chrono::milliseconds close_patience_;
  std::shared_ptr<Keeper> keeper_;  // the thread's too, which may outlast this object
  std::future<void> ended_;
  std::thread thread_;
};

}  // namespace server
