// space-foosball-server: passes options, devices, clock and random numbers to server_core.
#include <fmt/core.h>
#include <poll.h>
#include <signal.h>
#include <sys/random.h>
#include <unistd.h>

#include <array>
#include <atomic>
#include <cstdlib>
#include <cstring>
#include <ctime>
#include <exception>
#include <filesystem>
#include <memory>
#include <new>
#include <optional>
#include <set>
#include <system_error>

#include "cabinet/controller.h"
#include "cabinet/device_haptics.h"
#include "cabinet/device_source.h"
#include "cabinet/mouse_source.h"
#include "options.h"
#include "os/socket_address.h"
#include "os/time_of_day.h"
#include "server/exit_code.h"
#include "server/log_writer.h"
#include "server/report.h"
#include "server/run.h"

namespace {

std::atomic<bool> stop_requested{false};
static_assert(std::atomic<bool>::is_always_lock_free, "set by a signal handler");

extern "C" void request_stop(int) {
  stop_requested.store(true, std::memory_order_relaxed);
}

// Threads created while signals are blocked never receive them. The tick thread does; they end its
// sleep.
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
  if (::getrandom(&number, sizeof number, 0) != sizeof number) std::abort();  // never expected
  return number;
}

// Console output; nothing waits for its reader.
struct Outputs {
  server::LogWriter out{STDOUT_FILENO}, err{STDERR_FILENO};
};

std::string time_of_day() {
  timespec now{};
  tm local{};
  ::clock_gettime(CLOCK_REALTIME, &now);
  ::localtime_r(&now.tv_sec, &local);
  return fmt::format("{:02}:{:02}:{:02}.{:03}", local.tm_hour, local.tm_min, local.tm_sec,
                     now.tv_nsec / 1'000'000);
}

server::Log make_log(Outputs& outputs, bool quiet) {
  return [&outputs, quiet](server::LogLevel level, const std::string& text) {
    const bool info = level == server::LogLevel::info;
    if (quiet && info) return;
    outputs.err.write(fmt::format("{} {} {}\n", time_of_day(), info ? "info" : "warning", text));
  };
}

int fail(Outputs& outputs, int exit_code, const std::string& sentence) {
  outputs.err.write("space-foosball-server: " + sentence + "\n");
  return exit_code;
}

// Out-of-memory handler, called from any thread. It must not allocate. The journal file has all but
// the last ticks.
void leave_without_memory() {
  constexpr char kText[] =
      "space-foosball-server: out of memory: end other programs, or raise the limit of this one\n";
  pollfd polled{STDERR_FILENO, POLLOUT, 0};
  if (::poll(&polled, 1, 0) == 1) {
    [[maybe_unused]] const auto written = ::write(STDERR_FILENO, kText, sizeof kText - 1);
  }
  ::_exit(server::kExitFailed);
}

// Uses only letters and digits that are not easily confused: 50 bits. Each guess costs a
// connection.
std::string make_password() {
  constexpr char kLetters[] = "23456789abcdefghjkmnpqrstuvwxyz";
  std::string password;
  for (int i = 0; i < 10; ++i) {
    if (i == 5) password += '-';
    password += kLetters[random_number() % (sizeof kLetters - 1)];
  }
  return password;
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

struct Devices {
  std::vector<std::unique_ptr<cabinet::Device>> all;
  std::unique_ptr<cabinet::CabinetHaptics> haptics = std::make_unique<cabinet::CabinetHaptics>();
};

// The named calibration; otherwise the one that space-foosball calibrate has stored for the
// controller; otherwise the nominal one of the sensor.
tl::expected<cabinet::Calibration, std::string> calibration_of(const std::string& address,
                                                               const std::string& named,
                                                               const server::Log& log) {
  const bool recording = address.rfind("file:", 0) == 0;
  const std::string serial = cabinet::controller_serial(address);
  std::string file = named;
  if (file.empty() && !recording)
    file = cabinet::kept_calibration(cabinet::calibrations_folder(), serial);
  if (!file.empty()) {
    auto calibration = cabinet::load_calibration(file);
    if (!calibration) return calibration;
    log(server::LogLevel::info, address + " uses the calibration " + file);
    if (const auto conflict = cabinet::serial_conflict(*calibration, serial); !conflict.empty())
      log(server::LogLevel::warning, address + ": " + conflict + " (" + file +
                                         "): run space-foosball calibrate --device " + address +
                                         ", or give its own file with --calibration");
    return calibration;
  }
  log(server::LogLevel::info,
      address + " is not calibrated: its rods drift; run space-foosball calibrate --device " +
          address + ", or give a file with --calibration");
  return cabinet::nominal_calibration();
}

// Logs each text only once.
server::Log without_repeats(const server::Log& log) {
  return [log, reported = std::make_shared<std::set<std::string>>()](server::LogLevel level,
                                                                     const std::string& text) {
    if (reported->insert(text).second) log(level, text);
  };
}

// For a controller that is plugged in or replaced while the server runs.
cabinet::CalibrationFinder finder(const std::string& address, const server::Log& log) {
  return [address, log]() -> std::optional<cabinet::Calibration> {
    auto found = calibration_of(address, {}, log);
    if (found) return std::move(*found);
    log(server::LogLevel::warning, found.error());
    return std::nullopt;
  };
}

tl::expected<std::unique_ptr<cabinet::DeviceSource>, std::string> open_controller(
    const std::string& address, const std::string& named,
    const std::array<double, cabinet::kRods>& slide_limit, const server::Log& log) {
  if (std::string why = cabinet::why_no_device(address); !why.empty())
    return tl::unexpected(std::move(why));
  const server::Log once = without_repeats(log);
  const bool is_line = address.rfind("file:", 0) != 0;
  std::error_code unknown;
  const bool is_there = std::filesystem::exists(address.substr(address.find(':') + 1), unknown);
  tl::expected<cabinet::Calibration, std::string> own = cabinet::nominal_calibration();
  if (is_there || !named.empty()) own = calibration_of(address, named, once);
  if (!own) return tl::unexpected(own.error());
  const bool finds = is_line && named.empty();
  return cabinet::open_device(address, *own, slide_limit,
                              finds ? finder(address, once) : cabinet::CalibrationFinder());
}

tl::expected<Devices, std::string> open_devices(const app::Options& options,
                                                const server::Log& log) {
  tl::expected<cabinet::Calibration, std::string> calibration = cabinet::nominal_calibration();
  if (!options.calibration.empty()) calibration = cabinet::load_calibration(options.calibration);
  if (!calibration) return tl::unexpected(calibration.error());
  std::array<double, cabinet::kRods> slide_limit{};
  const auto& table = foosball::table_spec(options.match.layout);
  for (int rod = 0; rod < cabinet::kRods; ++rod) slide_limit[rod] = table.rods[rod].slide_limit;
  Devices devices;
  for (const app::Mouse& mouse : options.mice) {
    const int team = table.rods[mouse.rod].team;
    const auto rod = static_cast<std::size_t>(mouse.rod);
    cabinet::MouseOptions wanted;
    wanted.name = mouse.name;
    wanted.rod = mouse.rod;
    wanted.slide_limit = slide_limit[rod];
    wanted.calibration =
        options.calibration.empty()
            ? cabinet::hand_mouse(foosball::push_sign(team), -foosball::attack_sign(team))
            : calibration->rods[rod];
    auto device = cabinet::open_mouse(mouse.path, std::move(wanted));
    if (!device) return tl::unexpected(device.error());
    devices.all.push_back(std::move(*device));
  }
  for (const std::string& address : options.devices) {
    auto device = open_controller(address, options.calibration, slide_limit, log);
    if (!device) return tl::unexpected(device.error());
    devices.haptics->add(**device);
    devices.all.push_back(std::move(*device));
  }
  return devices;
}

// Remote clients need a password: if none was chosen, one is generated.
bool wants_password(const app::Options& options) {
  const auto listen = os::parse_address(options.network.listen, 0);
  return !options.access.password && listen && !listen->is_loopback();
}

tl::expected<std::unique_ptr<server::Server>, server::StartError> start(const app::Options& options,
                                                                        const server::Log& log) {
  using Kind = server::StartError::Kind;
  if (!options.stats_file.empty()) {
    const auto writable = server::can_write_whole(options.stats_file);
    if (!writable) return tl::unexpected(server::StartError{Kind::bad_option, writable.error()});
  }
  auto devices = open_devices(options, log);
  if (!devices) return tl::unexpected(server::StartError{Kind::bad_option, devices.error()});

  server::ServerOptions wanted;
  wanted.match = options.match;
  wanted.computer = options.computer;
  wanted.computer_fills = options.computer_fills;
  wanted.computer_player = options.computer_player;
  wanted.network = options.network;
  wanted.access = options.access;
  wanted.limits = options.limits;
  wanted.phones = options.phones;
  wanted.haptics = options.haptics;
  wanted.session = random_number();
  wanted.random = random_number;
  wanted.record = options.record;
  wanted.overwrite = options.overwrite;
  if (!options.recordings.empty()) {
    const auto path =
        server::new_recording(options.recordings, options.recording_limits, std::time(nullptr));
    if (path) wanted.record = *path;
    if (!path) log(server::LogLevel::warning, path.error());
    wanted.record_by_default_bytes = options.recording_limits.bytes_of_one;
  }
  wanted.results = options.results;
  wanted.date = os::utc_now;
  wanted.challenge_date = options.challenge_date;
  wanted.cabinet = !options.devices.empty();
  wanted.questionnaire = !options.no_questionnaire;
  wanted.await_client = options.await_client;
  // One below the tick, so that it never delays it, and above everything else.
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
  for (auto& device : devices->all) (*made)->add_device(std::move(device));
  (*made)->set_cabinet_haptics(std::move(devices->haptics));
  return made;
}

// The exit code by the recording and the results. asked_for: false for an automatic recording,
// which may fail.
int judge_record(const server::Server& server, bool asked_for, const server::Log& log) {
  const auto judge = [&log](const std::string& problem, int failed) {
    if (problem.empty()) return server::kExitOk;
    log(server::LogLevel::warning, problem);
    return failed;
  };
  const int recording =
      judge(server.journal_problem(), asked_for ? server::kExitFailed : server::kExitOk);
  const int results = judge(server.results_problem(), server::kExitFailed);
  return recording != server::kExitOk ? recording : results;
}

// The exit code by the replay. The summary contains the verdict too.
int judge_replay(const server::Server& server, bool quiet, const server::Log& log) {
  const server::Playback* playback = server.replay();
  if (playback == nullptr) return server::kExitOk;
  const int code = server::exit_code(playback->verdict());
  if (quiet && code != server::kExitOk)
    log(server::LogLevel::warning, playback->verdict_sentence());
  return code;
}

// The exit code by the network: a run that sent nothing has failed.
int judge_sending(const server::Server& server, const server::Log& log) {
  const server::Counters c = server.counters();
  if (c.send_errors == 0 || c.snapshots_sent > 0) return server::kExitOk;
  log(server::LogLevel::warning, fmt::format("none of {} snapshots could be sent: {}",
                                             c.send_errors, std::strerror(c.last_send_error)));
  return server::kExitFailed;
}

int serve(server::Server& server, const app::Options& options, Outputs& outputs,
          const server::Log& log) {
  if (!options.ready_file.empty()) {
    std::string text = "port=" + std::to_string(server.port()) + "\n";
    if (options.phones.open) text += "phones=" + server.phones() + "\n";
    const auto written = server::write_whole(options.ready_file, text);
    if (!written) return fail(outputs, server::kExitUsage, written.error());
  }
  const auto address = os::parse_address(options.network.listen, server.port());
  log(server::LogLevel::info, "listening at " + os::to_text(*address));
  if (options.password_was_made) {
    log(server::LogLevel::warning, "from another machine, join with the password " +
                                       *options.access.password +
                                       " (choose one with --password-file)");
  }
  if (options.phones.open) {
    log(server::LogLevel::info, "phones join at " + server.phones());
    const auto& own = options.phones.listen;
    const auto listen = own.empty() ? address : os::parse_address(own, 0);
    if (listen->is_loopback()) {
      log(server::LogLevel::warning,
          "no phone can reach this machine: give --phone-listen 0.0.0.0 too");
    }
  }
  server::TickLoop loop(options.loop, log);
  const server::RunEnd end = server::run(server, loop, options.run, stop_requested);
  server.finish(server::to_sentence(end));

  // Never both: a replay is not recorded.
  int code = options.replay.empty() ? judge_record(server, options.recordings.empty(), log)
                                    : judge_replay(server, options.quiet, log);
  if (code == server::kExitOk) code = judge_sending(server, log);
  if (!options.quiet) {
    outputs.out.write(fmt::format("{}:\n{}", server::to_sentence(end).text(),
                                  server::summary(server, loop.stats())));
  }
  if (options.stats_file.empty()) return code;
  const auto written = server::write_stats(server, loop.stats(), options.stats_file);
  return written ? code : fail(outputs, server::kExitFailed, written.error());
}

int run(int argc, char** argv, Outputs& outputs) {
  auto options = app::parse(argc, argv);
  if (!options) {
    const app::Leave& leave = options.error();
    if (leave.exit_code != server::kExitOk) return fail(outputs, leave.exit_code, leave.text);
    outputs.out.write(leave.text);
    return server::kExitOk;
  }
  if (wants_password(*options)) {
    options->access.password = make_password();
    options->password_was_made = true;
  }
  const server::Log log = make_log(outputs, options->quiet);
  auto server = [&] {
    const SignalsBlocked blocked;
    return start(*options, log);
  }();
  if (!server) return fail(outputs, exit_code(server.error().kind), server.error().sentence);
  return serve(**server, *options, outputs, log);
}

}  // namespace

int main(int argc, char** argv) {
  std::set_new_handler(leave_without_memory);
  try {
    std::optional<Outputs> outputs;
    {
      const SignalsBlocked blocked;  // the writer threads receive none
      outputs.emplace();
    }
    return run(argc, argv, *outputs);
  } catch (const std::exception& error) {  // mainly: no thread could be created
    const std::string text = std::string("space-foosball-server: ") + error.what() +
                             "; end other programs, or raise the limits of this one\n";
    [[maybe_unused]] const auto written = ::write(STDERR_FILENO, text.data(), text.size());
    return server::kExitFailed;
  }
}
