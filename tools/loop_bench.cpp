// loop-bench: measures the server's loop at 1 kHz with two computer players and N listeners in
// another process on loopback. Prints a table and writes the rows that ./bench stores.
#include <CLI/CLI.hpp>
#include <atomic>
#include <cstdio>

#include <fmt/format.h>

#include "listeners.h"
#include "server/exit_code.h"
#include "server/report.h"
#include "server/run.h"

namespace {

struct Options {
  double seconds = 60.0;
  int listeners = 10;
  int cpu = -1;
  std::uint64_t seed = 1;
  std::string csv;
};

struct Row {
  const char* metric;
  double value;
  const char* unit;
};

double us(std::int64_t ns) {
  return static_cast<double>(ns) * 1e-3;
}

std::vector<Row> rows(const server::LoopStats& loop, const server::SendStats& sending,
                      std::uint64_t sent, const bench::ListenerTotals& totals) {
  const double lost = static_cast<double>(sent) - static_cast<double>(totals.received);
  return {{"sent", static_cast<double>(sent), "datagrams"},
          {"received", static_cast<double>(totals.received), "datagrams"},
          {"lost", lost, "datagrams"},
          {"late_p50", us(loop.lateness.quantile(0.5)), "us"},
          {"late_p99", us(loop.lateness.quantile(0.99)), "us"},
          {"late_p999", us(loop.lateness.quantile(0.999)), "us"},
          {"late_max", us(loop.lateness.max()), "us"},
          {"missed_share", loop.missed_share(), "of ticks"},
          {"tick_p50", us(loop.cost.quantile(0.5)), "us"},
          {"tick_p99", us(loop.cost.quantile(0.99)), "us"},
          {"tick_p999", us(loop.cost.quantile(0.999)), "us"},
          {"tick_max", us(loop.cost.max()), "us"},
          {"send_p50", us(sending.cost.quantile(0.5)), "us"},
          {"send_p99", us(sending.cost.quantile(0.99)), "us"},
          {"to_wire_p50", us(sending.to_wire.quantile(0.5)), "us"},
          {"to_wire_p99", us(sending.to_wire.quantile(0.99)), "us"}};
}

std::string csv(const std::vector<Row>& rows) {
  std::string text = "subject,engine,metric,value,unit\n";
  for (const Row& row : rows) {
    text += fmt::format("loop,Virtual Physics,{},{:.6g},{}\n", row.metric, row.value, row.unit);
  }
  return text;
}

int fail(const std::string& sentence) {
  std::fprintf(stderr, "loop-bench: %s\n", sentence.c_str());
  return server::kExitFailed;
}

tl::expected<std::unique_ptr<server::Server>, server::StartError> make_server(
    const Options& options, int send_priority, const server::Log& log) {
  server::ServerOptions wanted;
  wanted.match.seed = options.seed;
  wanted.computer = {true, true};
  wanted.limits.connections = wanted.limits.per_local_address = options.listeners;
  wanted.session = options.seed;
  wanted.random = [token = options.seed]() mutable { return ++token; };
  wanted.send_priority = send_priority;
  wanted.log = log;
  return server::Server::create(std::move(wanted));
}

int measure(const Options& options) {
  bench::Listeners listeners(options.listeners);
  const server::Log log = [](server::LogLevel level, const std::string& text) {
    if (level == server::LogLevel::warning) std::fprintf(stderr, "loop-bench: %s\n", text.c_str());
  };
  server::LoopOptions loop_options;
  loop_options.cpu = options.cpu;
  auto server = make_server(options, loop_options.priority - 1, log);
  if (!server) return fail(server.error().sentence);
  if (!listeners.join((*server)->port())) return fail("not all listeners could join");

  server::TickLoop loop(loop_options, log);
  const std::atomic<bool> stop{false};
  const server::RunOptions run_options{
      .ticks = static_cast<std::uint64_t>(options.seconds / foosball::kTick)};
  server::run(**server, loop, run_options, stop);
  (*server)->finish(wire::Sentence::untranslated("the measurement is over"));
  const auto totals = listeners.totals();
  if (!totals || !totals->complete) return fail("the listeners ended before they were told to");

  if (totals->received == 0) return fail("the listeners received nothing");
  const auto counters = (*server)->counters();
  const auto table = rows(loop.stats(), (*server)->sending(), counters.snapshots_sent, *totals);
  std::printf("%d listeners, %.0f s, %zu bytes a snapshot\n", options.listeners,
              loop.stats().seconds,
              static_cast<std::size_t>(counters.snapshot_bytes /
                                       std::max<std::uint64_t>(1, counters.snapshots_sent)));
  for (const Row& row : table) fmt::print("{:<14}{:>14.6g} {}\n", row.metric, row.value, row.unit);
  fmt::print("gaps {}, out of order {}, bad {}, send errors {}\n", totals->gaps, totals->reordered,
             totals->bad, counters.send_errors);
  if (options.csv.empty()) return server::kExitOk;
  const auto written = server::write_whole(options.csv, csv(table));
  return written ? server::kExitOk : fail(written.error());
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App cli{"Measures the server's 1 kHz loop with listeners on loopback.", "loop-bench"};
  Options options;
  cli.add_option("--seconds", options.seconds, "to measure")->check(CLI::Range(0.1, 86400.0));
  cli.add_option("--listeners", options.listeners, "clients that take the snapshots")
      ->check(CLI::Range(1, 200));
  cli.add_option("--cpu", options.cpu, "pin the loop to this core")->check(CLI::Range(0, 1023));
  cli.add_option("--seed", options.seed, "of the match");
  cli.add_option("--csv", options.csv, "file for the figures");
  try {
    cli.parse(argc, argv);
  } catch (const CLI::CallForHelp&) {
    std::fputs(cli.help().c_str(), stdout);
    return server::kExitOk;
  } catch (const CLI::ParseError& error) {
    std::fprintf(stderr, "loop-bench: %s; --help explains the options\n", error.what());
    return server::kExitUsage;
  }
  return measure(options);
}
