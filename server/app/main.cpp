// space-foosball-server: options, devices, clock and randomness, handed to server_core.
#include <signal.h>
#include <spdlog/sinks/stdout_color_sinks.h>
#include <spdlog/spdlog.h>
#include <sys/random.h>

#include <array>
#include <atomic>
#include <cstdio>
#include <cstdlib>
#include <ctime>

#include "options.h"
#include "server/exit_code.h"
#include "server/report.h"
#include "server/run.h"

namespace {

std::atomic<bool> stop_requested{false};
static_assert(std::atomic<bool>::is_always_lock_free, "set by a signal handler");

extern "C" void request_stop(int) {
  stop_requested.store(true, std::memory_order_relaxed);
}

// Threads made while the signals are blocked never take them: they go to the tick's thread, whose
// sleep they end.
class SignalsBlocked {
 public:
  SignalsBlocked() {
    sigemptyset(&set_);
    for (const int signal : {SIGINT, SIGTERM, SIGHUP}) sigaddset(&set_, signal);
    pthread_sigmask(SIG_BLOCK, &set_, nullptr);
    struct sigaction action {};
    action.sa_handler = request_stop;
    for (const int signal : {SIGINT, SIGTERM, SIGHUP}) sigaction(signal, &action, nullptr);
    ::signal(SIGPIPE, SIG_IGN);
  }
  ~SignalsBlocked() { pthread_sigmask(SIG_UNBLOCK, &set_, nullptr); }

 private:
  sigset_t set_;
};

std::uint64_t random_number() {
  std::uint64_t number = 0;
  if (::getrandom(&number, sizeof number, 0) != sizeof number) std::abort();  // no kernel we know
  return number;
}

server::Log make_log(bool quiet) {
  auto logger = spdlog::stderr_color_mt("server");
  logger->set_pattern("%H:%M:%S.%e %^%l%$ %v");
  logger->set_level(quiet ? spdlog::level::warn : spdlog::level::info);
  return [logger](server::LogLevel level, const std::string& text) {
    logger->log(level == server::LogLevel::info ? spdlog::level::info : spdlog::level::warn, text);
  };
}

// Of now, in UTC.
std::string date() {
  const std::time_t now = std::time(nullptr);
  std::tm parts{};
  ::gmtime_r(&now, &parts);
  std::array<char, 32> text;
  return {text.data(), std::strftime(text.data(), text.size(), "%Y-%m-%dT%H:%M:%SZ", &parts)};
}

int fail(int exit_code, const std::string& sentence) {
  std::fprintf(stderr, "space-foosball-server: %s\n", sentence.c_str());
  return exit_code;
}

int exit_code(server::StartError::Kind kind) {
  switch (kind) {
    case server::StartError::Kind::bad_option:
      return server::kExitUsage;
    case server::StartError::Kind::port_taken:
      return server::kExitPortTaken;
    case server::StartError::Kind::failed:
      break;
  }
  return server::kExitFailed;
}

using Devices = std::vector<std::unique_ptr<cabinet::DeviceSource>>;

tl::expected<Devices, std::string> open_devices(const app::Options& options) {
  cabinet::Calibration calibration = cabinet::nominal_calibration();
  if (!options.calibration.empty()) {
    auto loaded = cabinet::load_calibration(options.calibration);
    if (!loaded) return tl::unexpected(loaded.error());
    calibration = *loaded;
  }
  std::array<double, cabinet::kRods> slide_limit{};
  const auto& table = foosball::table_spec(options.match.layout);
  for (int rod = 0; rod < cabinet::kRods; ++rod) slide_limit[rod] = table.rods[rod].slide_limit;
  Devices devices;
  for (const std::string& address : options.devices) {
    auto device = cabinet::open_device(address, calibration, slide_limit);
    if (!device) return tl::unexpected(device.error());
    devices.push_back(std::move(*device));
  }
  return devices;
}

tl::expected<std::unique_ptr<server::Server>, server::StartError> start(const app::Options& options,
                                                                        const server::Log& log) {
  using Kind = server::StartError::Kind;
  if (!options.stats_file.empty()) {
    const auto writable = server::can_write_whole(options.stats_file);
    if (!writable) return tl::unexpected(server::StartError{Kind::bad_option, writable.error()});
  }
  auto devices = open_devices(options);
  if (!devices) return tl::unexpected(server::StartError{Kind::bad_option, devices.error()});

  server::ServerOptions wanted;
  wanted.match = options.match;
  wanted.computer = options.computer;
  wanted.network = options.network;
  wanted.session = random_number();
  wanted.random = random_number;
  wanted.record = options.record;
  wanted.overwrite = options.overwrite;
  wanted.results = options.results;
  wanted.date = date;
  wanted.await_client = options.await_client;
  // Below the tick, which it must never hold up, and above all else.
  if (options.loop.paced && options.loop.real_time)
    wanted.send_priority = options.loop.priority - 1;
  wanted.log = log;
  if (!options.replay.empty()) {
    auto playback = server::Playback::open(options.replay);
    if (!playback) return tl::unexpected(server::StartError{Kind::bad_option, playback.error()});
    wanted.replay = std::move(*playback);
  }
  auto made = server::Server::create(std::move(wanted));
  if (!made) return made;
  for (auto& device : *devices) (*made)->add_device(std::move(device));
  return made;
}

// The exit code, as far as the recording and the results that were written have a say in it.
int judge_record(const server::Server& server, const server::Log& log) {
  int code = server::kExitOk;
  for (const std::string& problem : {server.journal_problem(), server.results_problem()}) {
    if (problem.empty()) continue;
    log(server::LogLevel::warning, problem);
    code = server::kExitFailed;
  }
  return code;
}

// The same for a replay. The summary says the verdict too.
int judge_replay(const server::Server& server, bool quiet, const server::Log& log) {
  const server::Playback* playback = server.replay();
  if (playback == nullptr) return server::kExitOk;
  const int code = server::exit_code(playback->verdict());
  if (quiet && code != server::kExitOk)
    log(server::LogLevel::warning, playback->verdict_sentence());
  return code;
}

int serve(server::Server& server, const app::Options& options, const server::Log& log) {
  if (!options.ready_file.empty()) {
    const auto written =
        server::write_whole(options.ready_file, "port=" + std::to_string(server.port()) + "\n");
    if (!written) return fail(server::kExitUsage, written.error());
  }
  log(server::LogLevel::info,
      "listening at " + options.network.listen + ":" + std::to_string(server.port()));
  server::TickLoop loop(options.loop, log);
  const server::RunEnd end = server::run(server, loop, options.run, stop_requested);
  server.finish(server::to_text(end));

  // Never both: a replay is not recorded.
  const int code =
      options.replay.empty() ? judge_record(server, log) : judge_replay(server, options.quiet, log);
  if (!options.quiet) {
    std::printf("%s:\n%s", server::to_text(end), server::summary(server, loop.stats()).c_str());
  }
  if (options.stats_file.empty()) return code;
  const auto written = server::write_stats(server, loop.stats(), options.stats_file);
  return written ? code : fail(server::kExitFailed, written.error());
}

}  // namespace

int main(int argc, char** argv) {
  const auto options = app::parse(argc, argv);
  if (!options) {
    const app::Leave& leave = options.error();
    if (leave.exit_code != server::kExitOk) return fail(leave.exit_code, leave.text);
    std::fputs(leave.text.c_str(), stdout);
    return server::kExitOk;
  }
  const server::Log log = make_log(options->quiet);
  auto server = [&] {
    const SignalsBlocked blocked;
    return start(*options, log);
  }();
  if (!server) return fail(exit_code(server.error().kind), server.error().sentence);
  return serve(**server, *options, log);
}
