#include "options.h"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <filesystem>
#include <set>
#include <thread>

#include "characters/character_file.h"
#include "foosball/computer_player.h"
#include "match/player.h"
#include "profile/judgment_profile.h"
#include "profile/tuning_profile.h"
#include "server/option_checks.h"

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
         "\n"
         "Every seed is played twice, with exchanged sides. The statistics are explained in\n"
         "docs/match-runner.md.\n\n"
         "Exit codes: 0 done; 1 something failed, a ball was stuck (--stuck-balls), or stopped\n"
         "before the end; 2 a bad option.";
}

// "5@FILE" with the file's name replaced by its values.
tl::expected<std::string, std::string> with_file_read(const std::string& name) {
  const auto at = name.find('@');
  if (at == std::string::npos || at + 1 == name.size()) return name;
  if (name.find('=', at) != std::string::npos) return name;  // values, not a file
  const std::string whose = name.substr(0, at);
  constexpr std::string_view kInner = "one-rod:";
  const std::string level = whose.starts_with(kInner) ? whose.substr(kInner.size()) : whose;
  const auto base = match::judgment_of_player(level);
  if (!base) return tl::unexpected(base.error());
  const auto judgment = profile::load_judgment(name.substr(at + 1), *base);
  if (!judgment) return tl::unexpected(judgment.error());
  return whose + "@" + changes_of(*base, *judgment);
}

std::string check_player(const std::string& name) {
  const auto read = with_file_read(name);
  if (!read) return read.error();
  const auto player = match::make_player({*read, 0, 1});
  return player ? "" : player.error();
}

// Precondition: check_player() has accepted the names.
void read_files(std::vector<std::string>& names) {
  for (std::string& name : names) name = with_file_read(name).value_or(name);
}

struct Raw {
  std::string home = match::default_player(), away = home;
  std::string layout = "tournament", characters, tuning, vary, seed;
  bool report = false, balance = false, study = false, traits = false, passive = false;
  bool stuck_balls = false;
  bool screen = false, train = false, matches_given = false;
  std::vector<std::string> sprt, round_robin;
  std::string parameters, list_judgment;
};

void add_options(CLI::App& cli, Options& o, Raw& raw) {
  auto* home = cli.add_option("--home", raw.home, "the first player")->check(check_player);
  auto* away = cli.add_option("--away", raw.away, "the second player")->check(check_player);
  cli.add_option("--layout", raw.layout, "paper (8 rods of 4 men) or tournament (1-2-5-3)")
      ->check(CLI::IsMember({"paper", "tournament"}));
  cli.add_option("--tuning", raw.tuning,
                 "profile of tuning values, TOML; space-foosball-server --list-tuning shows one");
  cli.add_option("--characters", raw.characters,
                 "folder of character files, instead of the built-in ones: docs/characters.md");
  cli.add_option("--seed", raw.seed,
                 "seed of the first pair of matches; each further pair has the next seed")
      ->check(server::check_seed);
  auto* passive =
      cli.add_flag("--passive", raw.passive, "the same as --away idle: play against an idle side");
  passive->excludes(away);
  auto* matches =
      cli.add_option("--matches", o.matches, "number of matches; in pairs, so an even number")
          ->check(CLI::Range(2, 100'000'000));
  cli.add_option("--max-minutes", o.max_minutes, "a match ends after this simulated time")
      ->check(CLI::Range(0.05, 600.0))
      ->check(server::check_not_nan);
  cli.add_option("--jobs", o.jobs, "number of threads; default: the number of cores")
      ->check(CLI::Range(1, 1024));
  auto* report = cli.add_flag("--report", raw.report,
                              "statistics of play with their goals, also against an idle side and "
                              "a spinner, with one rod, and of each character against the others");
  auto* stuck = cli.add_flag("--stuck-balls", raw.stuck_balls,
                             "how long nobody can reach the ball, or nobody plays it: --matches of "
                             "each level 1 to 5 against itself in each layout; exit code 1 if that "
                             "is longer than the rules allow");
  stuck->excludes(report)->excludes(home)->excludes(away)->excludes(passive);
  auto* sprt = cli.add_option("--sprt", raw.sprt,
                              "OLD NEW: play until it is clear whether NEW is the better one")
                   ->type_name("OLD NEW")
                   ->expected(2)
                   ->check(check_player);
  auto* robin = cli.add_option("--round-robin", raw.round_robin,
                               "A B ...: each against each other, with Elo ratings")
                    ->type_name("PLAYER ...")
                    ->expected(2, 64)
                    ->check(check_player);
  auto* balance = cli.add_flag("--balance", raw.balance,
                               "every pair of characters, played by --home: is any beyond 60:40?");
  for (auto* mode : {sprt, robin, balance}) {
    mode->excludes(report)->excludes(stuck)->excludes(matches);
    mode->excludes(away)->excludes(passive);
  }
  for (auto* mode : {sprt, robin}) mode->excludes(home)->excludes(balance);
  sprt->excludes(robin);
  auto* study = cli.add_flag(
      "--study", raw.study,
      "the effect of the tuning values on play, varied around those of --tuning: --matches at each "
      "point of a design, in both layouts, played by --home (docs/tuning-study.md)");
  study->excludes(report)->excludes(stuck)->excludes(sprt)->excludes(robin)->excludes(balance);
  study->excludes(away)->excludes(passive);
  auto* vary = cli.add_option(
      "--vary", raw.vary,
      "NAME:KEY=LOW:HIGH:STEPS, as in \"jumper:mass=0.05:0.09:5\": the points of a character "
      "against all others by one of its numbers, --matches at each value, played by --home");
  auto* traits = cli.add_flag(
      "--traits", raw.traits,
      "the differences between characters: each against itself, --matches each, played by --home");
  for (auto* mode : {vary, traits}) {
    mode->excludes(report)->excludes(stuck)->excludes(sprt)->excludes(robin);
    mode->excludes(balance)->excludes(study);
    mode->excludes(away)->excludes(passive);
  }
  vary->excludes(traits);
  auto* screen =
      cli.add_flag("--screen", raw.screen,
                   "the effect of each value of --home's judgment on the fraction of goals against "
                   "--opponents, --matches at each point of a design, in both layouts");
  auto* train = cli.add_flag("--train", raw.train,
                             "search for the judgment with which --home scores most against "
                             "--opponents, and test it on new seeds (docs/match-runner.md)");
  for (auto* mode : {screen, train}) {
    mode->excludes(report)->excludes(stuck)->excludes(sprt)->excludes(robin);
    mode->excludes(balance)->excludes(study);
    mode->excludes(vary)->excludes(traits)->excludes(away)->excludes(passive);
  }
  screen->excludes(train);
  match::TrainPlan& t = o.training;
  cli.add_option("--opponents", t.opponents, "of --screen and --train; default: 5 and classic:0.9")
      ->type_name("PLAYER ...")
      ->expected(1, 16)
      ->check(check_player);
  cli.add_option("--parameters", raw.parameters,
                 "NAME,NAME,...: the values that --screen or --train may change; default: all");
  cli.add_option("--generations", t.generations, "of --train")->check(CLI::Range(1, 100'000));
  cli.add_option("--population", t.population, "samples of a generation; default: 4 + 3 ln n, even")
      ->check(CLI::Range(4, 10'000));
  cli.add_option("--step", t.step,
                 "as a fraction of each range: the step of --screen; for --train, the deviation of "
                 "the first samples")
      ->check(CLI::Range(0.01, 0.5))
      ->check(server::check_not_nan);
  cli.add_option("--validate", t.validation,
                 "matches of the trained player against --home in each layout, on new seeds")
      ->check(CLI::Range(0, 100'000'000));
  cli.add_option("--write", o.write, "file for the trained values, for PLAYER@FILE");
  cli.add_option("--list-judgment", raw.list_judgment,
                 "print the values of a level's judgment, with ranges and meanings, as a file")
      ->type_name("PLAYER")
      ->check(check_player);
  cli.add_option("--samples", o.samples, "points of a study that fill the space of the values")
      ->check(CLI::Range(0, 100'000));
  cli.add_option("--elo0", o.elo0, "sequential test: H0, NEW is better by no more than this");
  cli.add_option("--elo1", o.elo1, "sequential test: H1, NEW is better by this");
  cli.add_option("--alpha", o.alpha, "fraction of wrong decisions for H1")
      ->check(CLI::Range(1e-6, 0.5))
      ->check(server::check_not_nan);
  cli.add_option("--beta", o.beta, "fraction of wrong decisions for H0")
      ->check(CLI::Range(1e-6, 0.5))
      ->check(server::check_not_nan);
  cli.add_option("--max-matches", o.max_matches,
                 "a sequential test stops after this number of matches")
      ->check(CLI::Range(2, 100'000'000));
  cli.add_option("--record", o.record, "folder for a recording of each match, for foosball-replay")
      ->check(CLI::ExistingDirectory);
  cli.add_option("--checkpoint", o.checkpoint,
                 "file that stores finished matches; the same command continues from there");
  cli.add_option("--results", o.results,
                 "add each match to this file; space-foosball-results lists them");
  cli.add_option("--csv", o.csv, "write the results there too, - for standard output");
  cli.add_option("--json", o.json, "write the results there too, - for standard output");
  cli.add_flag("--quiet", o.quiet, "no progress");
}

struct NamedMode {
  Mode mode;
  const char* name;
};
constexpr NamedMode kModes[] = {{Mode::report, "--report"},   {Mode::stuck_balls, "--stuck-balls"},
                                {Mode::sprt, "--sprt"},       {Mode::round_robin, "--round-robin"},
                                {Mode::balance, "--balance"}, {Mode::study, "--study"},
                                {Mode::vary, "--vary"},       {Mode::traits, "--traits"},
                                {Mode::screen, "--screen"},   {Mode::train, "--train"}};

std::string name_of(Mode mode) {
  for (const NamedMode& named : kModes) {
    if (named.mode == mode) return named.name;
  }
  return "matches";
}

// Rejects options that the mode ignores: they would suggest an effect that they do not have.
std::string objection_to_mode(const CLI::App& cli, Mode mode) {
  struct Rule {
    const char* option;
    std::vector<Mode> modes;
  };
  const std::vector<Mode> search{Mode::screen, Mode::train}, train{Mode::train};
  const std::vector<Mode> test{Mode::sprt, Mode::round_robin};
  const std::vector<Mode> sequential{Mode::sprt, Mode::round_robin, Mode::balance};
  const Rule rules[] = {{"--opponents", search},
                        {"--parameters", search},
                        {"--step", search},
                        {"--generations", train},
                        {"--population", train},
                        {"--validate", train},
                        {"--write", train},
                        {"--samples", {Mode::study}},
                        {"--elo0", test},
                        {"--elo1", test},
                        {"--beta", test},
                        {"--alpha", sequential},
                        {"--max-matches", sequential}};
  for (const Rule& rule : rules) {
    if (cli.get_option(rule.option)->count() == 0) continue;
    if (std::ranges::find(rule.modes, mode) != rule.modes.end()) continue;
    std::string names;
    for (const Mode read : rule.modes) names += (names.empty() ? "" : " or ") + name_of(read);
    return std::string(rule.option) + " is used with " + names + " only";
  }
  const Mode both[] = {Mode::stuck_balls, Mode::study, Mode::screen, Mode::train};
  if (cli.get_option("--layout")->count() > 0 && std::ranges::find(both, mode) != std::end(both))
    return name_of(mode) + " plays in both layouts: omit --layout";
  return {};
}

// Rejects two outputs in one file: they would be mixed, or the later would overwrite the earlier.
std::string objection_to_same_files(const Options& o) {
  const std::pair<const char*, const std::string*> outputs[] = {{"--csv", &o.csv},
                                                                {"--json", &o.json},
                                                                {"--write", &o.write},
                                                                {"--checkpoint", &o.checkpoint},
                                                                {"--results", &o.results}};
  const auto place = [](const std::string& path) {
    std::error_code error;
    const auto whole = std::filesystem::weakly_canonical(path, error);
    return error ? std::filesystem::path(path).lexically_normal() : whole;
  };
  for (const auto& [option, path] : outputs) {
    for (const auto& [before, other] : outputs) {
      if (before == option) break;
      if (path->empty() || other->empty() || place(*path) != place(*other)) continue;
      const std::string where = *path == "-" ? "standard output" : *path;
      return std::string(before) + " and " + option + " both go to " + where +
             ": give one of them another file";
    }
  }
  return {};
}

// Additional requirements of --screen and --train.
std::string translate_training(Options& o, const Raw& raw) {
  o.mode = raw.train ? Mode::train : Mode::screen;
  constexpr std::uint64_t kTrained = 4, kScreened = 8;
  if (!raw.matches_given) o.matches = raw.train ? kTrained : kScreened;
  const auto judgment = match::judgment_of_player(o.players[0]);
  if (!judgment) return "--home: " + judgment.error();
  const auto fields = match::parse_fields(raw.parameters);
  if (!fields) return "--parameters: " + fields.error();
  match::TrainPlan& plan = o.training;
  plan.player = o.players[0];
  plan.fields = *fields;
  plan.matches = o.matches + o.matches % 2;
  plan.validation += plan.validation % 2;
  read_files(plan.opponents);
  return {};
}

std::string translate(Options& o, const Raw& raw) {
  o.layout = raw.layout == "paper" ? foosball::Layout::paper : foosball::Layout::tournament;
  if (!raw.tuning.empty()) {
    const auto tuning = profile::load_tuning(raw.tuning);
    if (!tuning) return tuning.error();
    o.tuning = *tuning;
  }
  if (!raw.seed.empty()) o.seed = *server::parse_seed(raw.seed);
  o.players = {raw.home, raw.passive ? "idle" : raw.away};
  if (raw.report) o.mode = Mode::report;
  if (raw.stuck_balls) o.mode = Mode::stuck_balls;
  if (raw.balance) o.mode = Mode::balance;
  if (raw.study) o.mode = Mode::study;
  if (!raw.sprt.empty()) {
    o.mode = Mode::sprt;
    o.players = {raw.sprt[1], raw.sprt[0]};  // NEW is the first player: the test is about its score
  }
  if (!raw.round_robin.empty()) {
    o.mode = Mode::round_robin;
    o.players = raw.round_robin;
    read_files(o.players);
    if (std::set<std::string>(o.players.begin(), o.players.end()).size() != o.players.size()) {
      return "--round-robin has a player twice: name each once";
    }
  }
  read_files(o.players);
  if (raw.screen || raw.train) {
    if (auto objection = translate_training(o, raw); !objection.empty()) return objection;
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

tl::expected<std::string, std::string> list_judgment(const std::string& name) {
  const auto player = with_file_read(name);
  if (!player) return tl::unexpected(player.error());
  const auto judgment = match::judgment_of_player(*player);
  const auto base = match::judgment_of_player(player->substr(0, player->find('@')));
  if (!judgment || !base) return tl::unexpected((judgment ? base : judgment).error());
  return profile::format_judgment(*judgment, *base);
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
    raw.matches_given = cli.get_option("--matches")->count() > 0;
    objection = translate(options, raw);
    if (objection.empty()) objection = objection_to_mode(cli, options.mode);
    if (objection.empty()) objection = objection_to_same_files(options);
  } catch (const CLI::CallForHelp&) {
    return tl::unexpected(Leave{0, cli.help()});
  } catch (const CLI::ParseError& error) {
    objection = error.what();
  }
  if (objection.empty() && !raw.list_judgment.empty()) {
    const auto listed = list_judgment(raw.list_judgment);
    if (listed) return tl::unexpected(Leave{0, *listed});
    objection = "--list-judgment: " + listed.error();
  }
  if (objection.empty()) return options;
  return tl::unexpected(Leave{2, objection + "; --help explains the options"});
}

}  // namespace app
