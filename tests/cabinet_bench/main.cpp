// cabinet-bench: runs a whole match, or an hour of faults, with the controllers' firmware in
// simulators.
#include <CLI/CLI.hpp>
#include <chrono>
#include <cstdio>

#include <fmt/format.h>

#include "calibration.h"
#include "fault_run.h"
#include "match_run.h"
#include "motion.h"

namespace {

using namespace cabinet_bench;

constexpr double kDegrees = 180 / 3.14159265358979323846;

struct Options {
  std::vector<std::string> boards{"32u4", "2560", "rp2040"};
  double seconds = 600;
  double counts_per_mm = 0;  // 0: the board's usual value
  bool square = false;
  bool no_marks = false, no_swings = false;
  int level = 4;
  std::uint64_t seed = 1;
  bool faults = false;
  double minutes = 1;
  double troubles = 20;
  std::string csv;
  std::vector<std::string> moves;
  std::string recording;
};

Table table_of(const Options& options, double counts_per_mm) {
  // Marks are useful only with a calibration that has detected them.
  const bool marks = !options.square && !options.no_marks;
  return {options.square ? Mounting::square : Mounting::drawn, marks ? Marks::drawn : Marks::none,
          counts_per_mm, static_cast<std::uint32_t>(options.seed)};
}

class Rows {
 public:
  void add(const std::string& subject, const std::string& metric, double value,
           const std::string& unit) {
    text_ += fmt::format("{},Virtual Physics,{},{:.6g},{}\n", subject, metric, value, unit);
  }
  bool write(const std::string& path) const {
    std::FILE* file = std::fopen(path.c_str(), "w");
    if (file == nullptr) return false;
    const bool written = std::fputs(text_.c_str(), file) >= 0;
    return std::fclose(file) == 0 && written;
  }

 private:
  std::string text_ = "subject,engine,metric,value,unit\n";
};

class Stopwatch {
 public:
  double seconds() const {
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - began_).count();
  }

 private:
  std::chrono::steady_clock::time_point began_ = std::chrono::steady_clock::now();
};

void report(const std::string& board, const std::string& what, const Errors& errors, Rows& rows) {
  const Spread slide = spread(errors.slide), angle = spread(errors.angle);
  const double within = 100 * share_within(errors, 1e-3, 2 / kDegrees);
  fmt::print("  {:<24} {:6.2f} {:6.2f} {:6.2f} mm  {:6.2f} {:6.2f} {:6.2f} deg  {:6.2f} %\n", what,
             1e3 * slide.rms, 1e3 * slide.p99, 1e3 * slide.max, kDegrees * angle.rms,
             kDegrees * angle.p99, kDegrees * angle.max, within);
  const std::string name = what.substr(0, what.find(' '));
  rows.add(board, name + "_slide_rms", 1e3 * slide.rms, "mm");
  rows.add(board, name + "_slide_p99", 1e3 * slide.p99, "mm");
  rows.add(board, name + "_slide_max", 1e3 * slide.max, "mm");
  rows.add(board, name + "_angle_rms", kDegrees * angle.rms, "degrees");
  rows.add(board, name + "_angle_p99", kDegrees * angle.p99, "degrees");
  rows.add(board, name + "_angle_max", kDegrees * angle.max, "degrees");
  rows.add(board, name + "_within", within, "% within 1 mm and 2 degrees");
}

void report(const std::string& board, const PulseCounts& pulses, Rows& rows) {
  const Spread latency = spread(pulses.latency_us);
  fmt::print(
      "  {} hits, {} pulses: {} begun at their motors, {} merged, {} missing, {} stray, {} not "
      "ended; from command to driver {:.2f} ms rms, {:.2f} p99, {:.2f} at most\n",
      pulses.hits, pulses.pulses, pulses.begun, pulses.merged, pulses.missing, pulses.stray,
      pulses.not_ended, 1e-3 * latency.rms, 1e-3 * latency.p99, 1e-3 * latency.max);
  rows.add(board, "pulses", static_cast<double>(pulses.pulses), "");
  rows.add(board, "pulses_missing", static_cast<double>(pulses.missing), "");
  rows.add(board, "pulse_latency_p99", 1e-3 * latency.p99, "ms");
  rows.add(board, "pulse_latency_max", 1e-3 * latency.max, "ms");
}

void report(const std::string& board, const MatchResult& match, Rows& rows) {
  const double minutes = static_cast<double>(match.marks.ticks) / 60e3;  // rod minutes
  const double passes = static_cast<double>(match.marks.passes) / minutes,
               slow = static_cast<double>(match.marks.slow) / minutes;
  fmt::print(
      "  index marks: rods at their near stop {:.1f} % of the time; of each rod {:.2f} passes a "
      "minute, {:.2f} slow; {} disagreed\n",
      100 * static_cast<double>(match.marks.at_stop) / static_cast<double>(match.marks.ticks),
      passes, slow, match.disagreements);
  rows.add(board, "mark_passes_slow", slow, "1/min");
}

bool play(Board board, const Options& options, Rows& rows) {
  const std::string name = name_of(board);
  const double counts_per_mm =
      options.counts_per_mm > 0 ? options.counts_per_mm : usual_counts_per_mm(board);
  Stopwatch watch;
  const auto controller = power_on(board);
  Table table = table_of(options, counts_per_mm);
  fmt::print("{}, {:.1f} counts/mm\n", name, counts_per_mm);
  cabinet::Calibration calibration = cabinet::nominal_calibration(counts_per_mm);
  if (options.square) {
    for (int ms = 0; ms < 4000; ++ms) table.pass(*controller);
  } else {
    const CalibrationResult made = calibrate(*controller, table);
    if (!made.problem.empty()) {
      fmt::print("  not calibrated: {}\n", made.problem);
      return false;
    }
    calibration = made.calibration;
    fmt::print(
        "  calibrated in {:.0f} s; places off by {:.2f} mm, {:.2f} deg rms (worst rod); {} index "
        "marks found\n",
        made.seconds, 1e3 * made.slide_rms, kDegrees * made.angle_rms, made.marks);
  }
  std::fflush(stdout);
  MatchOptions wanted;
  wanted.max_seconds = options.seconds;
  wanted.level = options.level;
  wanted.seed = options.seed;
  wanted.swings = !options.no_swings;
  const MatchResult match = play_match(*controller, table, calibration, wanted);
  fmt::print("  {:.0f} s of a match, {}:{}{}; hands up to {:.1f} m/s, {:.0f} rad/s\n",
             match.seconds, match.score[0], match.score[1], match.over ? ", over" : "",
             match.fastest_slide, match.fastest_angle);
  fmt::print("  {:<24} {:>6} {:>6} {:>6}     {:>6} {:>6} {:>6}      within 1 mm, 2 deg\n", "",
             "rms", "p99", "max", "rms", "p99", "max");
  report(name, "input at the tick", match.input, rows);
  report(name, "drifted, last minute", match.input.last(60'000), rows);
  report(name, "rod after the tick", match.rod, rows);
  report(name, "free of the ball", match.free, rows);
  report(name, "ideal: given the truth", match.ideal, rows);
  report(name, match.pulses, rows);
  if (table.has_marks()) report(name, match, rows);
  fmt::print("  {} frames: {} lost, {} bad, {} overflows, {} impossible, {} line errors\n",
             match.frames, match.lost, match.bad, match.overflows, match.impossible,
             match.line_errors);
  fmt::print("  simulated in {:.0f} s\n", watch.seconds());
  std::fflush(stdout);
  rows.add(name, "match", match.seconds, "s");
  return match.pulses.missing <= match.line_errors && match.pulses.stray == 0 &&
         match.pulses.not_ended == 0;
}

bool suffer(Board board, const Options& options, Rows& rows) {
  const std::string name = name_of(board);
  Stopwatch watch;
  const auto controller = power_on(board);
  FaultOptions wanted;
  wanted.seconds = 60 * options.minutes;
  wanted.troubles_per_minute = options.troubles;
  wanted.seed = static_cast<std::uint32_t>(options.seed);
  const FaultResult result = run_faults(*controller, wanted);
  const Ledger::Totals& t = result.totals;
  fmt::print("{}: {:.1f} simulated minutes in {:.0f} s\n", name, options.minutes, watch.seconds());
  int troubles = 0;
  for (const auto& [trouble, times] : result.troubles) {
    fmt::print("  {:<36} {:5}\n", trouble, times);
    troubles += times;
  }
  fmt::print(
      "  {} frames; counted: {} line errors, {} resynchronisations, {} overflows, {} absences, {} "
      "restarts\n",
      t.frames, t.errors, t.resynchronised, t.overflows, t.absences, t.restarts);
  const auto looks = static_cast<double>(t.frames) * cabinet::kRods;
  fmt::print(
      "  of all frames and rods {:.3f} % exact, {:.3f} % absent; {} times counts were "
      "missing and a fault was counted, {} times none was\n",
      100 * static_cast<double>(t.exact) / looks, 100 * static_cast<double>(t.absent) / looks,
      t.losses, t.unexplained);
  for (const std::string& violation : result.violations) fmt::print("  {}\n", violation);
  std::fflush(stdout);
  rows.add(name, "minutes", options.minutes, "min");
  rows.add(name, "troubles", troubles, "");
  rows.add(name, "losses_counted", static_cast<double>(t.losses), "");
  rows.add(name, "losses_not_counted", static_cast<double>(t.unexplained), "");
  return t.unexplained == 0;
}

bool write(const std::string& path, const std::vector<std::uint8_t>& bytes) {
  std::FILE* file = std::fopen(path.c_str(), "wb");
  if (file == nullptr) return false;
  const bool written = std::fwrite(bytes.data(), 1, bytes.size(), file) == bytes.size();
  return std::fclose(file) == 0 && written;
}

int record(const Options& options) {
  const Board board = *board_named(options.boards.front());
  const double counts_per_mm =
      options.counts_per_mm > 0 ? options.counts_per_mm : usual_counts_per_mm(board);
  Table table = table_of(options, counts_per_mm);
  std::vector<Motion> motions;
  for (const std::string& move : options.moves) motions.push_back(*motion_of(move));
  if (!write(options.recording, record_motions(*power_on(board), table, motions))) {
    fmt::print(stderr, "cabinet-bench: {} cannot be written; name another file.\n",
               options.recording);
    return 1;
  }
  fmt::print("written {}\n", options.recording);
  return 0;
}

int run(const Options& options) {
  if (!options.recording.empty()) return record(options);
  Rows rows;
  bool good = true;
  for (const std::string& name : options.boards) {
    const Board board = *board_named(name);
    good = (options.faults ? suffer(board, options, rows) : play(board, options, rows)) && good;
  }
  if (!options.csv.empty() && !rows.write(options.csv)) {
    fmt::print(stderr, "cabinet-bench: {} cannot be written; name another file.\n", options.csv);
    return 1;
  }
  return good ? 0 : 1;
}

}  // namespace

int main(int argc, char** argv) {
  Options options;
  CLI::App app{
      "A match whose rods simulated hands move on a simulated cabinet, through the controllers' "
      "own "
      "firmware in simulators; or, with --faults, troubles at random times."};
  app.add_option("--board", options.boards, "controllers: 32u4, 2560, rp2040; all by default")
      ->delimiter(',')
      ->check(CLI::IsMember({"32u4", "2560", "rp2040"}));
  app.add_option("--seconds", options.seconds, "of the match at most")
      ->check(CLI::Range(1.0, 3600.0));
  app.add_option("--counts-per-mm", options.counts_per_mm, "of the sensors")
      ->check(CLI::Range(1.0, 472.0));
  app.add_flag("--square", options.square, "sensors without errors, and no calibration");
  app.add_flag("--no-marks", options.no_marks, "rods without index marks");
  app.add_flag("--no-swings", options.no_swings,
               "hands do not pull their rods to the near stop, and swing them past their marks, "
               "before the match and after each goal");
  app.add_option("--level", options.level, "of the computer players that move the hands")
      ->check(CLI::Range(1, 5));
  app.add_option("--seed", options.seed);
  app.add_flag("--faults", options.faults, "troubles in place of a match");
  app.add_option("--minutes", options.minutes, "of troubles")->check(CLI::Range(0.1, 600.0));
  app.add_option("--troubles-per-minute", options.troubles)->check(CLI::Range(0.1, 600.0));
  app.add_option("--csv", options.csv, "a file for the results");
  auto* recording =
      app.add_option("--record", options.recording,
                     "no match: what the first board sends during --move, into a file");
  app.add_option("--move", options.moves,
                 "ROD:MM:TURNS: moves a rod (1 to 8) so far; one after the other")
      ->needs(recording)
      ->check([](const std::string& text) {
        return motion_of(text) ? std::string() : text + " is no motion: write 6:252:-5";
      });
  CLI11_PARSE(app, argc, argv);
  try {
    return run(options);
  } catch (const std::exception& failure) {
    fmt::print(stderr, "cabinet-bench: {}\n", failure.what());
    return 1;
  }
}
