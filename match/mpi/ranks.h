// Games handed out to ranks and taken back, by MPI messages of a few hundred bytes. Which rank
// played a game leaves no trace in the totals (match/schedule.h).
//
// A rank that is lost: what it had finished is with rank 0 (and on its disk, with --checkpoint);
// the game it was playing is handed out again once there is nothing else to play. Where the
// launcher ends the whole job when a rank dies, as mpirun does unless told otherwise, the same
// command goes on from the checkpoint.
#pragma once

#include <deque>
#include <string>
#include <tl/expected.hpp>
#include <vector>

#include "match/executor.h"

namespace ranks {

// Rank 0, of two or more.
class Coordinator {
 public:
  // series: what it begins with. A rank that would play it otherwise, since its program or its
  // options are others, is an error of play_all().
  explicit Coordinator(const std::vector<match::SeriesDesc>& series);
  // Tells all ranks that there is no more. Those that still play what is not needed any more are
  // waited for; one that does not answer is lost, and MPI could not be ended in order with it.
  ~Coordinator();
  Coordinator(const Coordinator&) = delete;
  Coordinator& operator=(const Coordinator&) = delete;

  // Until the schedule is finished. May be called again when more was added to it.
  tl::expected<match::Effort, std::string> play_all(match::Schedule& schedule,
                                                    const match::ExecutorOptions& options);

 private:
  int players_ = 0;
  std::string identity_;
  std::vector<int> waiting_;  // ranks without a game
  std::deque<match::JobId> under_way_;
};

// The others: plays what it is told until there is no more. series: what rank 0 begins with; a
// series beyond them differs from the first in players, layout and seed alone. The exit code.
int play(const std::vector<match::SeriesDesc>& series, const std::string& record_folder);

}  // namespace ranks
