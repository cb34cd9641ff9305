// tick-bench: measures the cost of the ticks of a match of two computer players, including the
// worst ones. The match is repeated several times, bit for bit. Each tick counts with its fastest
// repetition, because an interruption is no cost of the tick.
#include <CLI/CLI.hpp>
#include <algorithm>
#include <array>
#include <chrono>
#include <cstddef>
#include <cstdio>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "foosball/computer_player.h"
#include "foosball/match.h"

namespace {

struct Options {
  std::string player = "5";
  int seconds = 60;
  int repeats = 5;
  std::uint64_t seed = 1;
};

// What happens in a tick besides play.
enum class Kind { play, begins, tuned, after_tuning, stand_in, other };
constexpr std::array kKindNames{"play",           "play begins",     "tuning changes",
                                "the tick after", "stand-in begins", "other screens"};

struct Tick {
  Kind kind = Kind::other;
  double players = 1e9, match = 1e9;  // us
};

class Stopwatch {
 public:
  double us() {
    const auto now = std::chrono::steady_clock::now();
    const std::chrono::duration<double, std::micro> since = now - from_;
    from_ = now;
    return since.count();
  }

 private:
  std::chrono::steady_clock::time_point from_ = std::chrono::steady_clock::now();
};

// Two whole teams. Each kTuneEvery ticks of play a value of the tuning changes. Each kStandInEvery
// ticks another player of the same level takes over two rods of the first team, as for a person who
// lost the connection, and gives them back half of that time later.
constexpr int kTuneEvery = 5'000, kStandInEvery = 4'000;  // ticks
constexpr std::uint8_t kStandInRods = 0x0F;  // restricted to the rods of the first team

class Run {
 public:
  Run(foosball::Layout layout, const Options& options)
      : match_(*foosball::Match::create({.layout = layout,
                                         .seed = options.seed,
                                         .rules = {.goals_to_win = 99, .max_goals = 99}})),
        home_(player(options, 0, 1)),
        away_(player(options, 1, 2)),
        mate_(player(options, 0, 3)) {}

  void step(Tick& tick) {
    const foosball::MatchView& view = match_.view();
    const bool playing = view.screen == foosball::Screen::play;
    const bool begins = playing && !was_playing_;
    was_playing_ = playing;
    played_ += playing ? 1 : 0;
    commands_.clear();
    const bool tunes = playing && played_ % kTuneEvery == 0;
    if (tunes) {
      const int gravity = foosball::tuning_index("gravity");
      const double value = view.tuning.gravity > 12.0 ? 12.0 : 12.1;
      commands_.push_back(
          {foosball::Command::Kind::tune, 0, static_cast<std::uint8_t>(gravity), value});
    }
    const bool stands_in = playing && played_ > 0 && played_ % kStandInEvery < kStandInEvery / 2;
    const bool comes = stands_in && !stood_in_;
    stood_in_ = stands_in;
    tick.kind = begins    ? Kind::begins
                : tuned_  ? Kind::after_tuning
                : tunes   ? Kind::tuned
                : comes   ? Kind::stand_in
                : playing ? Kind::play
                          : Kind::other;
    tuned_ = tunes;
    input_.commands = commands_;
    const std::uint8_t mate = stands_in ? kStandInRods : 0;
    Stopwatch watch;
    home_.play(view, input_.rods, static_cast<std::uint8_t>(~mate));
    mate_.play(view, input_.rods, mate);
    away_.play(view, input_.rods);
    tick.players = std::min(tick.players, watch.us());
    match_.step(input_);
    tick.match = std::min(tick.match, watch.us());
  }
  std::uint64_t hash() const { return match_.state_hash(); }

 private:
  static foosball::ComputerPlayer player(const Options& options, int team, std::uint64_t which) {
    return foosball::ComputerPlayer({.team = team,
                                     .seed = 3 * options.seed + which,
                                     .player = *foosball::parse_player(options.player)});
  }

  foosball::Match match_;
  foosball::ComputerPlayer home_, away_, mate_;
  foosball::TickInput input_;
  std::vector<foosball::Command> commands_;
  bool was_playing_ = false, tuned_ = false, stood_in_ = false;
  int played_ = 0;
};

void print_row(const char* what, std::vector<double> us) {
  if (us.empty()) return;
  std::sort(us.begin(), us.end());
  double sum = 0.0;
  for (const double each : us) sum += each;
  const auto at = [&](double share) {
    return us[static_cast<std::size_t>(share * static_cast<double>(us.size() - 1))];
  };
  fmt::print("  {:<28}{:>8}{:>9.1f}{:>9.1f}{:>9.1f}{:>9.1f}{:>9.1f}\n", what, us.size(),
             sum / static_cast<double>(us.size()), at(0.5), at(0.99), at(0.999), us.back());
}

// False if two repetitions differed.
bool measure(foosball::Layout layout, const Options& options) {
  std::vector<Tick> ticks(static_cast<std::size_t>(options.seconds) * 1000);
  std::uint64_t hash = 0;
  for (int repeat = 0; repeat < options.repeats; ++repeat) {
    Run run(layout, options);
    for (Tick& tick : ticks) run.step(tick);
    if (repeat > 0 && run.hash() != hash) return false;
    hash = run.hash();
  }
  fmt::print("{}, {} against {}, us\n  {:<28}{:>8}{:>9}{:>9}{:>9}{:>9}{:>9}\n",
             layout == foosball::Layout::paper ? "paper" : "tournament", options.player,
             options.player, "", "ticks", "mean", "median", "99 %", "99.9 %", "worst");
  for (std::size_t kind = 0; kind < kKindNames.size(); ++kind) {
    std::vector<double> players, match, both;
    for (const Tick& tick : ticks) {
      if (static_cast<std::size_t>(tick.kind) != kind) continue;
      players.push_back(tick.players);
      match.push_back(tick.match);
      both.push_back(tick.players + tick.match);
    }
    print_row(fmt::format("{}: players", kKindNames[kind]).c_str(), std::move(players));
    print_row("  match", std::move(match));
    print_row("  both", std::move(both));
  }
  return true;
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app("What the ticks of a match of computer players cost, the worst of them too.");
  Options options;
  std::string layout;
  app.add_option("--player", options.player, "Both sides' player")
      ->check([](const std::string& text) {
        const auto spec = foosball::parse_player(text);
        return spec ? std::string() : spec.error().message;
      });
  app.add_option("--seconds", options.seconds, "Simulated")->check(CLI::Range(1, 3600));
  app.add_option("--repeats", options.repeats, "Of the same match")->check(CLI::Range(1, 100));
  app.add_option("--seed", options.seed, "Of the match");
  app.add_option("--layout", layout, "Only this one")
      ->check(CLI::IsMember({"paper", "tournament"}));
  CLI11_PARSE(app, argc, argv);
  bool same = true;
  if (layout != "paper") same = measure(foosball::Layout::tournament, options) && same;
  if (layout != "tournament") same = measure(foosball::Layout::paper, options) && same;
  if (!same) std::fprintf(stderr, "tick-bench: the same match was not the same again\n");
  return same ? 0 : 1;
}
