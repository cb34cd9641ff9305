// multibody-bench: times forward and inverse dynamics and the mass matrix of a list of models in
// Virtual Physics and in its peers, whose results must agree first. Times the derivatives in
// Virtual Physics alone. Prints tables and writes the CSV rows that ./bench stores.
#include <fmt/format.h>
#include <sched.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstdio>
#include <fstream>

#include "report.h"

namespace {

using namespace vp::bench;

constexpr int kExitFailed = 1, kExitUsage = 2;

int fail(int code, const std::string& sentence) {
  std::fprintf(stderr, "multibody-bench: %s\n", sentence.c_str());
  return code;
}

std::vector<std::string> engine_options() {
  std::vector<std::string> options;
  for (const EngineKind& kind : kEngines) options.emplace_back(kind.option);
  return options;
}

// Pins the process to one core: no engine is moved to another core while it is timed.
void stay_on_this_core() {
  const int core = sched_getcpu();
  if (core < 0) return;
  cpu_set_t cores;
  CPU_ZERO(&cores);
  CPU_SET(static_cast<unsigned>(core), &cores);
  sched_setaffinity(0, sizeof(cores), &cores);
}

// Our own results that were rejected.
std::vector<std::string> doubts(const std::vector<Figure>& figures) {
  std::vector<std::string> out;
  for (const Figure& f : figures) {
    if (f.engine == kEngines[0].name && !f.missing.empty()) {
      out.push_back(f.model + ", " + f.metric + ": " + f.missing);
    }
  }
  return out;
}

int run(const Plan& plan, bool compile, const std::string& file) {
  stay_on_this_core();
  const auto said = [](const std::string& what) { std::fprintf(stderr, "  %s\n", what.c_str()); };
  tl::expected<CompileCost, std::string> cost = tl::make_unexpected(std::string());
  if (compile) {
    said("a user's program");
    cost = compile_cost();
    if (!cost) return fail(kExitFailed, cost.error());
  }
  const std::vector<Figure> figures = measure(plan, said);
  const std::vector<Goal> reached = goals(figures, cost ? &*cost : nullptr);
  fmt::print("{}{}{}", agreement_table(figures, plan), times_table(figures, plan),
             batch_table(figures, plan));
  if (!reached.empty()) fmt::print("{}", goals_table(reached));
  const auto wrong = doubts(figures);
  for (const std::string& doubt : wrong) fail(kExitFailed, doubt);
  if (!wrong.empty()) return kExitFailed;
  if (file.empty()) return 0;
  std::ofstream out(file);
  out << csv(figures, reached);
  out.close();
  return out ? 0 : fail(kExitFailed, "cannot write " + file);
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App cli{"Compares articulated dynamics with other engines, which must agree first.",
               "multibody-bench"};
  Plan plan{.models = model_names(), .engines = engine_options()};
  std::string file;
  cli.add_option("--models", plan.models, "of " + CLI::detail::join(model_names()))
      ->delimiter(',')
      ->check(CLI::IsMember(model_names()));
  cli.add_option("--only", plan.engines, "these engines, of " + CLI::detail::join(engine_options()))
      ->delimiter(',')
      ->check(CLI::IsMember(engine_options()));
  cli.add_option("--seconds", plan.seconds, "for all of it")->check(CLI::Range(0.1, 86400.0));
  cli.add_option("--csv", file, "file for the figures");
  try {
    cli.parse(argc, argv);
  } catch (const CLI::CallForHelp&) {
    std::fputs(cli.help().c_str(), stdout);
    return 0;
  } catch (const CLI::ParseError& error) {
    return fail(kExitUsage, std::string(error.what()) + "; --help explains the options");
  }
  const bool ours =
      std::count(plan.engines.begin(), plan.engines.end(), std::string(kEngines[0].option)) != 0;
  return run(plan, ours, file);
}
