// space-foosball-results: lists finished matches and the hall of fame, and exports them.
#include <CLI/CLI.hpp>
#include <cstdio>
#include <fstream>

#include "results/questionnaire.h"
#include "results/rating.h"
#include "results/store.h"
#include "results/text.h"
#include "server/exit_code.h"

namespace {

struct Options {
  std::string file, player, csv, format = "table";
  std::size_t newest = 0;
  std::uint64_t min_matches = 1;
};

int fail(int code, const std::string& why) {
  std::fprintf(stderr, "space-foosball-results: %s\n", why.c_str());
  return code;
}

int print(const std::string& text) {
  const bool ok = std::fputs(text.c_str(), stdout) >= 0 && std::fflush(stdout) == 0;
  return ok ? server::kExitOk : fail(server::kExitFailed, "cannot write; is the disk full?");
}

int list(const Options& options, const std::vector<results::MatchResult>& matches) {
  if (options.format == "csv") return print(results::matches_csv(matches));
  if (options.format == "json") return print(results::matches_json(matches));
  if (matches.empty()) return print("no match with a winner in " + options.file + "\n");
  return print(results::matches_table(matches));
}

int write(const std::string& path, const std::string& text) {
  std::ofstream file(path, std::ios::binary | std::ios::trunc);
  file << text;
  file.close();
  return file ? server::kExitOk
              : fail(server::kExitFailed,
                     "cannot write " + path + "; check the disk space and the permissions");
}

// Prints the summary, or in CSV the answers.
int questionnaire(const Options& options, const results::Store& store,
                  const std::vector<results::MatchResult>& matches) {
  const auto answers = store.answers();
  if (!answers) return fail(server::kExitUsage, answers.error());
  const std::string rows = results::answers_csv(*answers, matches);
  if (!options.csv.empty()) {
    if (const int code = write(options.csv, rows); code != server::kExitOk) return code;
  }
  if (options.format == "csv") return print(rows);
  if (options.format == "json") return print(results::answers_json(*answers));
  return print(results::answers_table(*answers));
}

int hall_of_fame(const Options& options, const std::vector<results::MatchResult>& matches) {
  std::vector<results::Standing> all = results::standings(matches);
  std::erase_if(all, [&](const auto& s) { return s.matches < options.min_matches; });
  if (options.newest != 0 && all.size() > options.newest) all.resize(options.newest);
  if (options.format == "csv") return print(results::standings_csv(all));
  if (options.format == "json") return print(results::standings_json(all));
  return print(results::standings_table(all));
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App cli{
      "Lists finished matches, who plays best, and what players answered afterwards. The file is "
      "the\n"
      "one that a server writes with --results FILE.\n\nExit codes: 0 printed; 1 it could not be "
      "written; 2 a bad option or "
      "file.",
      "space-foosball-results"};
  Options options;
  cli.require_subcommand(1);
  const auto common = [&](CLI::App* command) {
    command->add_option("FILE", options.file, "the results")->required();
    command->add_option("--format", options.format, "table, csv or json")
        ->check(CLI::IsMember({"table", "csv", "json"}));
    return command;
  };
  CLI::App* matches = common(cli.add_subcommand("matches", "finished matches, the newest last"));
  matches->add_option("--newest", options.newest, "only this number of rows")
      ->check(CLI::Range(1, 1'000'000));
  matches->add_option("--player", options.player, "only those of this player");
  CLI::App* fame =
      common(cli.add_subcommand("fame", "the hall of fame: players by their rating (Elo)"));
  fame->add_option("--top", options.newest, "only this number of rows")
      ->check(CLI::Range(1, 1'000'000));
  fame->add_option("--least", options.min_matches,
                   "only players with at least this number of matches (default 1)")
      ->check(CLI::Range(1, 1'000'000));
  CLI::App* asked = common(cli.add_subcommand(
      "questionnaire",
      "what players answered after matches: n, median and mean of each question; --format csv has "
      "the answers themselves (docs/questionnaire.md)"));
  asked->add_option("--csv", options.csv, "write the answers to this file too");
  try {
    cli.parse(argc, argv);
  } catch (const CLI::CallForHelp&) {
    return print(cli.help("", CLI::AppFormatMode::All));
  } catch (const CLI::ParseError& error) {
    return fail(server::kExitUsage, std::string(error.what()) + "; --help explains the options");
  }
  const auto store = results::Store::open(options.file, results::Access::read_only);
  if (!store) return fail(server::kExitUsage, store.error());
  results::Store::Filter filter{options.player, matches->parsed() ? options.newest : 0};
  const auto found = store->matches(filter);
  if (!found) return fail(server::kExitUsage, found.error());
  if (asked->parsed()) return questionnaire(options, *store, *found);
  return matches->parsed() ? list(options, *found) : hall_of_fame(options, *found);
}
