// Games handed out to ranks and taken back, by MPI messages of a few hundred bytes. Which rank
// played a game leaves no trace in the totals (match/schedule.h).
//
// A rank that is lost: what it had finished is with rank 0 (and on its disk, with --checkpoint);
// the game it was playing is handed out again once there is nothing else to play. Where the
// launcher ends the whole job when a rank dies, as mpirun does unless told otherwise, the same
// command goes on from the checkpoint.
#pragma once

#include <string>
#include <tl/expected.hpp>

#include "match/executor.h"

namespace ranks {

// Rank 0, of two or more.
tl::expected<match::Effort, std::string> coordinate(match::Schedule& schedule,
                                                    const match::ExecutorOptions& options);
// The others: plays what it is told until there is no more. The exit code.
int play(const match::Schedule& schedule, const std::string& record_folder);

}  // namespace ranks
