// Distributes games to ranks and collects the results, by MPI messages of a few hundred bytes. The
// totals do not depend on the rank that plays a game (match/schedule.h).
//
// A lost rank: rank 0 has its finished games (and on disk, with --checkpoint). The game that it was
// playing is assigned again when no other games are left. If the launcher ends the job when a rank
// dies, as mpirun does by default, the same command continues from the checkpoint.
#pragma once

#include <deque>
#include <string>
#include <tl/expected.hpp>
#include <vector>

#include "match/executor.h"

namespace ranks {

// Rank 0 of two or more.
class Coordinator {
 public:
  // series: the initial ones. play_all() fails if a rank would play them differently, because its
  // program or options differ.
  explicit Coordinator(const std::vector<match::SeriesDesc>& series);
  // Tells all ranks to stop. Waits for ranks that play games which are no longer needed. A rank
  // that does not answer is lost, and prevents an orderly shutdown of MPI.
  ~Coordinator();
  Coordinator(const Coordinator&) = delete;
  Coordinator& operator=(const Coordinator&) = delete;

  // Returns when the schedule is finished. May be called again after series were added to it.
  tl::expected<match::Effort, std::string> play_all(match::Schedule& schedule,
                                                    const match::ExecutorOptions& options);

 private:
  int players_ = 0;
  std::string identity_;
  std::vector<int> waiting_;  // ranks without a game
  std::deque<match::JobId> under_way_;
};

// The other ranks: plays assigned games until rank 0 stops it. Returns the exit code. series: the
// initial ones of rank 0; later series differ from the first only in players, layout and seed.
int play(const std::vector<match::SeriesDesc>& series, const std::string& record_folder);

}  // namespace ranks
