// Stores results in their file on its own thread: the tick passes them on and never waits. A file
// that is damaged, locked or cannot be created is reported, but stops nothing. Results stay queued,
// up to the queue's capacity, until the file accepts them or the program ends.
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
  std::chrono::milliseconds retry_period{10'000};   // while results are pending
  std::chrono::milliseconds close_patience{4'000};  // for a locked file: results::kBusy_ms
};

class ResultsLog {
 public:
  static constexpr std::size_t kWaiting = 64;  // results; a match takes minutes
  // A report computes ratings from this many of the newest matches, and names this many of the best
  // players.
  static constexpr std::size_t kRated = 10'000, kFame = 8;

  explicit ResultsLog(const ResultsLogOptions& options);
  ~ResultsLog();  // calls close() if it was not called

  // Tick thread, like answer(). Returns false if the queue is full: the result is lost and counted.
  // number: chosen by the caller for answer(); increases.
  bool add(results::MatchResult result, std::uint32_t number = 0);
  // A player's answers after the match of that number, stored with it; lost and counted if the
  // match was lost. At most one per rod: the store rejects the second.
  bool answer(const results::Answers& answers, std::uint32_t number);
  // Tries once more to store pending results, and ends the thread. If that takes longer than
  // close_patience, the thread is abandoned. Do not call from the running loop.
  void close();

  // Any thread. Empty, or the sentence with the reason why results cannot be stored now.
  std::string problem() const;
  // Tick thread. True if the problem has changed since the last call. Also false while the thread
  // writes it.
  bool problem_changed(wire::Sentence& problem);
  // The latest stored data: the last match of this run, and the best players of all matches.
  struct Report {
    std::uint32_t number = 0;  // of add(); 0: none yet
    results::MatchResult match;
    std::array<double, results::kTeams> rating{}, change{};  // mean of the team's players
    std::vector<results::Standing> fame;                     // best first
  };
  // Tick thread. True if there is a new report since the last call. Also false while it is being
  // written.
  bool report_changed(Report& report);
  std::uint64_t kept() const;     // matches
  std::uint64_t answers() const;  // stored

 private:
  class Keeper;

  std::string path_;
  std::chrono::milliseconds close_patience_;
  std::shared_ptr<Keeper> keeper_;  // shared with the thread, which may outlive this object
  std::future<void> ended_;
  std::thread thread_;
};

}  // namespace server
