#include "match/executor.h"

#include <condition_variable>
#include <cstdio>
#include <fstream>
#include <mutex>
#include <thread>
#include <vector>

#include "os/clock.h"

namespace match {
namespace {

class Pool {
 public:
  Pool(Schedule& schedule, const ExecutorOptions& options)
      : schedule_(schedule), options_(options) {}

  tl::expected<Effort, std::string> run() {
    const std::int64_t begun = os::monotonic_ns();
    std::vector<std::thread> threads;
    threads.reserve(static_cast<std::size_t>(options_.jobs));
    for (int i = 0; i < options_.jobs; ++i) threads.emplace_back([this] { work(); });
    for (std::thread& thread : threads) thread.join();
    effort_.seconds = static_cast<double>(os::monotonic_ns() - begun) * 1e-9;
    if (!problem_.empty()) return tl::unexpected(problem_);
    return effort_;
  }

 private:
  bool stopped() const {
    return !problem_.empty() || (options_.stop != nullptr && options_.stop->load());
  }

  // A thread ends when no game is left that may be needed: games in progress elsewhere can only
  // reduce the need.
  void work() {
    while (true) {
      JobId id;
      GameDesc game;
      {
        const std::lock_guard lock(mutex_);
        const auto next = stopped() ? std::nullopt : schedule_.next();
        if (!next) return;
        id = *next;
        game = schedule_.game(id);
      }
      const std::int64_t before = os::thread_ns();
      const auto result = play_job(game, id, options_.record_folder);
      const std::int64_t cost = os::thread_ns() - before;
      const std::lock_guard lock(mutex_);
      if (!take(id, result, cost)) return;
    }
  }

  bool take(JobId id, const tl::expected<GameResult, std::string>& result, std::int64_t cost_ns) {
    if (!result) {
      problem_ = result.error();
      return false;
    }
    effort_.core_seconds += static_cast<double>(cost_ns) * 1e-9;
    effort_.ticks += result->statistics.ticks;
    ++effort_.games;
    if (auto kept = keep(schedule_, options_, id, *result); !kept) {
      problem_ = kept.error();
      return false;
    }
    if (options_.progress) options_.progress(schedule_, effort_);
    return true;
  }

  Schedule& schedule_;
  const ExecutorOptions& options_;
  std::mutex mutex_;
  Effort effort_;
  std::string problem_;
};

}  // namespace

tl::expected<void, std::string> keep(Schedule& schedule, const ExecutorOptions& options, JobId id,
                                     const GameResult& result) {
  if (!schedule.complete(id, result)) return {};
  if (options.checkpoint != nullptr) {
    const std::uint64_t series = schedule.series()[id.series].digest_of_desc();
    if (auto kept = options.checkpoint->append(id, series, result); !kept) return kept;
  }
  if (options.taken) options.taken(schedule.game(id), id, result);
  return {};
}

tl::expected<Effort, std::string> play_all(Schedule& schedule, const ExecutorOptions& options) {
  return Pool(schedule, options).run();
}

std::string journal_name(JobId id, const GameDesc& game) {
  char name[96];
  std::snprintf(name, sizeof name, "series%03zu-game%06llu-seed%llu.sfr", id.series,
                static_cast<unsigned long long>(id.game),
                static_cast<unsigned long long>(game.seed));
  return name;
}

tl::expected<GameResult, std::string> play_job(const GameDesc& game, JobId id,
                                               const std::string& record_folder) {
  const bool recorded = !record_folder.empty();
  PlayedGame played = play_game(game, recorded ? Recording::on : Recording::off);
  if (recorded) {
    const std::string path = record_folder + "/" + journal_name(id, game);
    std::ofstream file(path, std::ios::binary | std::ios::trunc);
    file.write(reinterpret_cast<const char*>(played.journal.data()),
               static_cast<std::streamsize>(played.journal.size()));
    file.close();
    if (!file)
      return tl::unexpected("cannot write " + path + "; is there space, may it be written?");
  }
  return played.result;
}

}  // namespace match
