// space-foosball-match-mpi: the same matches on the ranks of a cluster, under mpirun or Slurm. Rank
// 0 assigns the games and collects the results; the other ranks play. A single rank plays with
// threads.
#include <mpi.h>

#include "options.h"
#include "plan.h"
#include "ranks.h"
#include "run.h"

namespace {

int play_ranks(int rank, int ranks, const app::Options& options) {
  if (ranks == 1) return app::run(options, match::play_all);
  if (rank != 0) return ranks::play(app::series_of(options), options.record);
  ranks::Coordinator coordinator(app::series_of(options));
  return app::run(options, [&](match::Schedule& schedule, const match::ExecutorOptions& executor) {
    return coordinator.play_all(schedule, executor);
  });
}

}  // namespace

int main(int argc, char** argv) {
  MPI_Init(&argc, &argv);
  int rank = 0, ranks = 1;
  MPI_Comm_rank(MPI_COMM_WORLD, &rank);
  MPI_Comm_size(MPI_COMM_WORLD, &ranks);
  const auto options = app::parse(argc, argv);
  int code = 2;
  if (options) {
    code = play_ranks(rank, ranks, *options);
  } else if (rank == 0) {
    code = app::leave(options.error());
  } else {
    code = options.error().exit_code;
  }
  MPI_Finalize();
  return code;
}
