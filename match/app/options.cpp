#include "options.h"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <set>
#include <thread>

#include "characters/character_file.h"
#include "match/player.h"
#include "profile/tuning_profile.h"

namespace app {
namespace {

std::string footer() {
  std::string text = "Players:\n";
  for (const auto& kind : match::player_kinds()) {
    text += "  " + kind.syntax +
            std::string(kind.syntax.size() < 20 ? 22 - kind.syntax.size() : 2, ' ') + kind.meaning +
            "\n";
  }
  return text +
         "\nEvery seed is played twice with the sides changed over. What the figures mean:\n"
         "docs/match-runner.md.\n\n"
         "Exit codes: 0 done; 1 something failed, or stopped before it was done; 2 a bad option.";
}

std::string check_player(const std::string& name) {
  const auto player = match::make_player({name, 0, 1});
  return player ? "" : player.error();
}

struct Raw {
  std::string home = "classic", away = "classic", layout = "tournament", characters, tuning, vary;
  bool report = false, balance = false, study = false, traits = false, passive = false;
  std::vector<std::string> sprt, round_robin;
};

void add_options(CLI::App& cli, Options& o, Raw& raw) {
  auto* home = cli.add_option("--home", raw.home, "the first player")->check(check_player);
  auto* away = cli.add_option("--away", raw.away, "the second player")->check(check_player);
  cli.add_option("--layout", raw.layout, "paper (8 rods of 4 men) or tournament (1-2-5-3)")
      ->check(CLI::IsMember({"paper", "tournament"}));
  auto* tuning = cli.add_option(
      "--tuning", raw.tuning,
      "profile of tuning values, TOML; space-foosball-server --list-tuning shows one");
  cli.add_option("--characters", raw.characters,
                 "folder of character files, in place of the built-in ones: docs/characters.md");
  cli.add_option("--seed", o.seed, "of the first pair of matches; the next has the next");
  auto* passive = cli.add_flag("--passive", raw.passive,
                               "the same as --away idle: what an idle side makes of play");
  passive->excludes(away);
  auto* matches = cli.add_option("--matches", o.matches, "to play; in pairs, so an even number")
                      ->check(CLI::Range(2, 100'000'000));
  cli.add_option("--max-minutes", o.max_minutes, "a match is over after so much simulated time")
      ->check(CLI::Range(0.05, 600.0));
  cli.add_option("--jobs", o.jobs, "threads that play; as many as there are cores")
      ->check(CLI::Range(1, 1024));
  auto* report = cli.add_flag("--report", raw.report,
                              "figures of play, each beside its goal, also against an idle side, a "
                              "spinner, with one rod, and of each character against the others");
  auto* sprt = cli.add_option("--sprt", raw.sprt,
                              "OLD NEW: play until it is clear whether NEW is the better one")
                   ->type_name("OLD NEW")
                   ->expected(2)
                   ->check(check_player);
  auto* robin =
      cli.add_option("--round-robin", raw.round_robin, "A B ...: each against each, and their Elo")
          ->type_name("PLAYER ...")
          ->expected(2, 64)
          ->check(check_player);
  auto* balance = cli.add_flag("--balance", raw.balance,
                               "every pair of characters, played by --home: is any beyond 60:40?");
  for (auto* mode : {sprt, robin, balance})
    mode->excludes(report)->excludes(matches)->excludes(away)->excludes(passive);
  for (auto* mode : {sprt, robin}) mode->excludes(home)->excludes(balance);
  sprt->excludes(robin);
  auto* study = cli.add_flag("--study", raw.study,
                             "what the tuning values do to play: --matches at each point of a "
                             "design, in both layouts, played by --home (docs/tuning-study.md)");
  study->excludes(report)->excludes(sprt)->excludes(robin)->excludes(balance);
  study->excludes(away)->excludes(passive)->excludes(tuning);
  auto* vary = cli.add_option(
      "--vary", raw.vary,
      "NAME:KEY=LOW:HIGH:STEPS, as in \"jumper:mass=0.05:0.09:5\": the points of a character "
      "against all others by one of its numbers, --matches at each value, played by --home");
  auto* traits = cli.add_flag("--traits", raw.traits,
                              "what sets characters apart: each against itself, --matches each, "
                              "played by --home");
  for (auto* mode : {vary, traits}) {
    mode->excludes(report)->excludes(sprt)->excludes(robin)->excludes(balance)->excludes(study);
    mode->excludes(away)->excludes(passive);
  }
  vary->excludes(traits);
  cli.add_option("--samples", o.samples, "points of a study that fill the space of the values")
      ->needs(study)
      ->check(CLI::Range(0, 100'000));
  cli.add_option("--elo0", o.elo0, "sequential test: H0, NEW is better by no more than this");
  cli.add_option("--elo1", o.elo1, "sequential test: H1, NEW is better by this");
  cli.add_option("--alpha", o.alpha, "share of wrong decisions for H1")
      ->check(CLI::Range(1e-6, 0.5));
  cli.add_option("--beta", o.beta, "share of wrong decisions for H0")->check(CLI::Range(1e-6, 0.5));
  cli.add_option("--max-matches", o.max_matches, "a sequential test gives up after so many")
      ->check(CLI::Range(2, 100'000'000));
  cli.add_option("--record", o.record, "folder for a recording of each match, for foosball-replay")
      ->check(CLI::ExistingDirectory);
  cli.add_option("--checkpoint", o.checkpoint,
                 "file that keeps finished matches; the same command goes on from there");
  cli.add_option("--results", o.results,
                 "add each match that is played to this file; space-foosball-results lists them");
  cli.add_option("--csv", o.csv, "write the results there too, - for standard output");
  cli.add_option("--json", o.json, "write the results there too, - for standard output");
  cli.add_flag("--quiet", o.quiet, "no progress");
}

std::string translate(Options& o, const Raw& raw) {
  o.layout = raw.layout == "paper" ? foosball::Layout::paper : foosball::Layout::tournament;
  if (!raw.tuning.empty()) {
    const auto tuning = profile::load_tuning(raw.tuning);
    if (!tuning) return tuning.error();
    o.tuning = *tuning;
  }
  o.players = {raw.home, raw.passive ? "idle" : raw.away};
  if (raw.report) o.mode = Mode::report;
  if (raw.balance) o.mode = Mode::balance;
  if (raw.study) o.mode = Mode::study;
  if (!raw.sprt.empty()) {
    o.mode = Mode::sprt;
    o.players = {raw.sprt[1], raw.sprt[0]};  // NEW is the first: the test is about its score
  }
  if (!raw.round_robin.empty()) {
    o.mode = Mode::round_robin;
    o.players = raw.round_robin;
    if (std::set<std::string>(o.players.begin(), o.players.end()).size() != o.players.size()) {
      return "--round-robin has a player twice: name each once";
    }
  }
  if (!(o.elo0 < o.elo1)) return "--elo0 must be below --elo1";
  if (std::fabs(o.elo0) > 1000.0 || std::fabs(o.elo1) > 1000.0) {
    return "--elo0 and --elo1 are from -1000 to 1000";
  }
  if (!raw.characters.empty()) {
    auto list = characters::load_characters(raw.characters);
    if (!list) return list.error();
    o.character_list = std::move(*list);
  }
  if (raw.traits) o.mode = Mode::traits;
  if (!raw.vary.empty()) {
    o.mode = Mode::vary;
    const auto varied = match::parse_varied(raw.vary, o.character_list);
    if (!varied) return varied.error();
    o.varied = *varied;
  }
  o.matches += o.matches % 2;
  o.max_matches += o.max_matches % 2;
  return {};
}

}  // namespace

tl::expected<Options, Leave> parse(int argc, const char* const* argv) {
  CLI::App cli{"Plays matches of computer players without a screen, as fast as this machine can.",
               "space-foosball-match"};
  Options options;
  options.jobs = static_cast<int>(std::clamp(std::thread::hardware_concurrency(), 1u, 1024u));
  Raw raw;
  add_options(cli, options, raw);
  cli.footer(footer());
  std::string objection;
  try {
    cli.parse(argc, argv);
    objection = translate(options, raw);
  } catch (const CLI::CallForHelp&) {
    return tl::unexpected(Leave{0, cli.help()});
  } catch (const CLI::ParseError& error) {
    objection = error.what();
  }
  if (objection.empty()) return options;
  return tl::unexpected(Leave{2, objection + "; --help explains the options"});
}

}  // namespace app
