#include "run.h"

#include <signal.h>
#include <unistd.h>

#include <atomic>
#include <cerrno>
#include <cinttypes>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <memory>
#include <optional>
#include <span>

#include "match/checkpoint.h"
#include "match/executor.h"
#include "match/report.h"
#include "plan.h"
#include "profile/judgment_profile.h"
#include "progress.h"
#include "result_writer.h"

namespace {

std::atomic<bool> stop_requested{false};

extern "C" void request_stop(int) {
  stop_requested.store(true);
}

// A second signal terminates the program immediately.
void end_on_signals() {
  struct sigaction action {};
  action.sa_handler = request_stop;
  action.sa_flags = static_cast<int>(SA_RESETHAND);
  for (const int signal : {SIGINT, SIGTERM, SIGHUP}) sigaction(signal, &action, nullptr);
}

bool write_text(const std::string& path, const std::string& text) {
  if (path.empty()) return true;
  if (path == "-") return std::fwrite(text.data(), 1, text.size(), stdout) == text.size();
  std::ofstream file(path, std::ios::binary | std::ios::trunc);
  file << text;
  file.close();
  return static_cast<bool>(file);
}

// Checks before the run that the file can be written at its end. Returns the problem, or an empty
// text.
std::string objection_to_file(const std::string& path) {
  if (path.empty() || path == "-") return {};
  std::error_code error;
  if (std::filesystem::is_directory(path, error))
    return "cannot write " + path + ": it is a folder";
  const std::string folder = std::filesystem::path(path).parent_path();
  const std::string asked = std::filesystem::exists(path, error) ? path
                            : folder.empty()                     ? "."
                                                                 : folder;
  if (::access(asked.c_str(), W_OK) == 0) return {};
  return "cannot write " + path + ": " + std::strerror(errno) +
         "; choose a file in a folder that can be written";
}

void print_effort(const match::Effort& effort) {
  std::printf("\n%" PRIu64
              " matches played in %.1f s, %.1f s of one core: %.0f times real time on "
              "one core\n",
              effort.games, effort.seconds, effort.core_seconds, effort.real_time_factor());
}

// Plays the scheduled series. A training then adds one round after another, each based on the
// results of the previous one. play: plays the schedule to its end.
template <class Play>
tl::expected<match::Effort, std::string> play_rounds(
    match::Schedule& schedule, std::optional<match::Training>& training,
    const std::vector<match::Checkpoint::Line>& known, const Play& play) {
  match::Effort sum;
  for (std::size_t first = 0; first < schedule.series().size();) {
    const std::size_t end = schedule.series().size();
    for (const auto& line : known) {
      if (line.id.series < first || line.id.series >= end) continue;
      if (line.series != schedule.series()[line.id.series].digest_of_desc()) {
        return tl::unexpected(std::string(
            "the checkpoint has games of other samples than this search draws: it was begun by "
            "another version of the search; finish it with that version, or give another file"));
      }
      schedule.know(line.id, line.result);
    }
    const auto effort = play();
    if (!effort) return effort;
    sum.games += effort->games;
    sum.ticks += effort->ticks;
    sum.core_seconds += effort->core_seconds;
    sum.seconds += effort->seconds;
    if (!training || !schedule.finished()) break;
    training->take(std::span(schedule.series()).subspan(first));
    schedule.add(training->round());
    first = end;
  }
  return sum;
}

}  // namespace

namespace app {

int fail(int exit_code, const std::string& sentence) {
  std::fprintf(stderr, "space-foosball-match: %s\n", sentence.c_str());
  return exit_code;
}

int leave(const Leave& leave) {
  if (leave.exit_code != 0) return fail(leave.exit_code, leave.text);
  std::fputs(leave.text.c_str(), stdout);
  return 0;
}

int run(const Options& options, const PlayAll& play_all) {
  end_on_signals();
  for (const std::string* path : {&options.csv, &options.json, &options.write}) {
    const std::string objection = objection_to_file(*path);
    if (!objection.empty()) return fail(2, objection);
  }
  std::optional<match::Training> training;
  if (options.mode == Mode::train) training.emplace(train_plan(options));
  const std::vector<match::SeriesDesc> plan = series_of(options);
  match::Schedule schedule(plan);
  match::Checkpoint::Opened known;
  if (!options.checkpoint.empty()) {
    auto opened = match::Checkpoint::open(options.checkpoint, plan,
                                          training ? train_plan(options).text() : std::string());
    if (!opened) return fail(2, opened.error());
    known = std::move(*opened);
  }
  std::optional<ResultWriter> writer;
  if (!options.results.empty()) {
    auto opened = ResultWriter::open(options.results);
    if (!opened) return fail(2, opened.error());
    writer = std::move(*opened);
  }
  Progress progress(options.quiet);
  match::ExecutorOptions executor;
  executor.jobs = options.jobs;
  executor.record_folder = options.record;
  executor.checkpoint = known.checkpoint.get();
  executor.stop = &stop_requested;
  executor.progress = [&](const match::Schedule& s, const match::Effort& e) {
    progress.show(s, e);
  };
  if (writer) {
    executor.taken = [&](const match::GameDesc& game, match::JobId id, const match::GameResult& r) {
      writer->add(game, r,
                  options.record.empty() ? std::string()
                                         : options.record + "/" + match::journal_name(id, game));
    };
  }
  if (training) progress.expect(training->games_at_most());
  const auto effort = play_rounds(schedule, training, known.lines, [&] {
    if (training && training->generations() > 0) progress.note(training->state());
    return play_all(schedule, executor);
  });
  progress.finish();
  const std::string unsaved = writer ? writer->finish() : std::string();
  if (!unsaved.empty()) fail(1, unsaved);
  if (!effort) return fail(1, effort.error());

  const Results results = training ? results_of_training(*training, schedule.series())
                                   : results_of(options, schedule.series());
  if (options.csv != "-" && options.json != "-") {
    std::fputs(results.text.c_str(), stdout);
    print_effort(*effort);
  }
  if (!write_text(options.csv, match::as_csv(results.figures))) {
    return fail(1, "the results could not be written to " + options.csv);
  }
  if (!write_text(options.json, match::as_json(results.figures))) {
    return fail(1, "the results could not be written to " + options.json);
  }
  if (training && !options.write.empty() &&
      !write_text(options.write, profile::format_judgment(training->answer(), training->start()))) {
    return fail(1, "the trained values could not be written to " + options.write);
  }
  if (!schedule.finished()) return fail(1, "stopped before all matches were played");
  return unsaved.empty() && !results.falls_short ? 0 : 1;
}

}  // namespace app
