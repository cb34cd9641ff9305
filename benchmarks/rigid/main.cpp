// rigid-bench: scenes of rigid bodies in Virtual Physics and in its peers. Prints tables and writes
// the CSV rows that ./bench stores.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <set>

#include "agreement.h"
#include "load.h"
#include "report.h"

namespace {

using namespace rigid;

constexpr int kExitFailed = 1, kExitUsage = 2;

int fail(int code, const std::string& sentence) {
  std::fprintf(stderr, "rigid-bench: %s\n", sentence.c_str());
  return code;
}

std::vector<std::string> engine_options() {
  std::vector<std::string> options;
  for (const EngineKind& kind : kEngines) options.emplace_back(kind.option);
  return options;
}

// One line for each engine that has reported its settings.
std::string settings(const std::vector<Figure>& figures) {
  std::string out = "\n";
  std::set<std::string> told;
  for (const Figure& f : figures) {
    if (!f.settings.empty() && told.insert(f.engine).second) {
      out += fmt::format("  {:<30}{}\n", f.engine, f.settings);
    }
  }
  return out;
}

int run(const Plan& plan, const std::string& file) {
  for (const std::string& name : plan.scenes) {
    if (const auto scene = load(name); !scene) return fail(kExitUsage, scene.error().message);
  }
  std::ofstream(plan.log).close();  // clears the errors of earlier runs
  const auto said = [](const std::string& what) { std::fprintf(stderr, "  %s\n", what.c_str()); };
  said("what is known in closed form");
  const auto agreed = agreement(plan);
  fmt::print("{}", agreement_table(agreed));
  std::fflush(stdout);
  const Plan timed = of_those_who_agree(plan, agreed);
  std::vector<Figure> figures;
  for (const std::string& scene : plan.scenes) {
    for (const int rate : plan.rates) {
      Plan one = timed;
      one.scenes = {scene};
      one.rates = {rate};
      auto of_race = measure(one, said);
      fmt::print("{}", table(of_race));
      std::fflush(stdout);
      for (Figure& figure : of_race) {
        figure.poses.clear();
        figures.push_back(std::move(figure));
      }
    }
  }
  fmt::print("{}{}", settings(figures), goals_table(figures));
  if (file.empty()) return 0;
  std::ofstream out(file);
  out << csv(figures);
  out.close();
  return out ? 0 : fail(kExitFailed, "cannot write " + file);
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App cli{"Compares scenes of rigid bodies with other engines.", "rigid-bench"};
  Plan plan{
      .scenes = {"towers1120",    "pyramid1128",    "pile1120",     "wall1128",    "pile10k",
                 "ragdolls",      "chain200",       "bridge",       "joint_grid",  "rain",
                 "trees100",      "trees25",        "washer",       "convex_pile", "junkyard",
                 "large_pyramid", "shaken_pyramid", "stirred_pile", "table1",      "table200"},
      .rates = {60, 240, 1000},
      .engines = engine_options()};
  // Large scenes with goals at 60 Hz only. Scenes named by --scenes run at all rates.
  const std::set<std::string> after_box3d{
      "joint_grid",  "rain",     "trees100",      "trees25",        "washer",
      "convex_pile", "junkyard", "large_pyramid", "shaken_pyramid", "stirred_pile"};
  std::string file;
  plan.programs = std::filesystem::path(argv[0]).parent_path().string();
  if (plan.programs.empty()) plan.programs = ".";
  const auto* scenes =
      cli.add_option("--scenes", plan.scenes, "names of scenes/, heapN, tableN")->delimiter(',');
  cli.add_option("--rates", plan.rates, "steps a second")
      ->delimiter(',')
      ->check(CLI::Range(1, 100000));
  cli.add_option("--only", plan.engines, "these engines, of " + CLI::detail::join(engine_options()))
      ->delimiter(',')
      ->check(CLI::IsMember(engine_options()));
  cli.add_option("--seconds", plan.seconds, "of processor time for a run, at most")
      ->check(CLI::Range(0.1, 86400.0));
  cli.add_option("--seconds-at-60", plan.seconds_at_60, "the same at 60 Hz and below")
      ->check(CLI::Range(0.1, 86400.0));
  cli.add_option("--scripts", plan.scripts, "folder of run.mjs, wasi.mjs and node_modules");
  cli.add_option("--wasm", plan.wasm, "folder of our own WebAssembly build");
  cli.add_option("--log", plan.log, "file for what the engines complain of");
  cli.add_option("--csv", file, "file for the figures");
  try {
    cli.parse(argc, argv);
  } catch (const CLI::CallForHelp&) {
    std::fputs(cli.help().c_str(), stdout);
    return 0;
  } catch (const CLI::ParseError& error) {
    return fail(kExitUsage, std::string(error.what()) + "; --help explains the options");
  }
  if (scenes->count() == 0) plan.at_60_alone = after_box3d;
  return run(plan, file);
}
