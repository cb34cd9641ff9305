#include "server/report.h"

#include <fmt/format.h>

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <numeric>
#include <system_error>
#include <vector>

namespace server {
namespace {

std::uint64_t mean_latency_us(const cabinet::SourceCounters& counters) {
  return counters.stamped > 0 ? counters.latency_sum_us / counters.stamped : 0;
}

double us(std::int64_t ns) {
  return static_cast<double>(ns) * 1e-3;
}

double per_second(std::uint64_t count, const LoopStats& loop) {
  return loop.seconds > 0.0 ? static_cast<double>(count) / loop.seconds : 0.0;
}

struct Figure {
  const char* name;
  double value;
};

double number(std::uint64_t count) {
  return static_cast<double>(count);
}

cabinet::SourceCounters all_devices(const Server& server) {
  cabinet::SourceCounters sum;
  for (const DeviceCounters& device : server.devices()) sum = sum + device.counters;
  return sum;
}

std::uint64_t index_disagreements(const cabinet::SourceCounters& counters) {
  return std::accumulate(counters.index_disagreements.begin(), counters.index_disagreements.end(),
                         std::uint64_t{0});
}

std::vector<Figure> figures(const Server& server, const LoopStats& loop) {
  const Counters c = server.counters();
  const SendStats& sending = server.sending();
  const cabinet::SourceCounters devices = all_devices(server);
  const auto& score = server.match().view().score;
  return {
      {"score0", static_cast<double>(score[0])},
      {"score1", static_cast<double>(score[1])},
      {"seconds", loop.seconds},
      {"ticks", number(c.ticks)},
      {"ticks_per_second", per_second(loop.ticks, loop)},
      {"ticks_missed", number(loop.missed)},
      {"missed_share", loop.missed_share()},
      {"late_p50_us", us(loop.lateness.quantile(0.5))},
      {"late_p99_us", us(loop.lateness.quantile(0.99))},
      {"late_p999_us", us(loop.lateness.quantile(0.999))},
      {"late_max_us", us(loop.lateness.max())},
      {"tick_p50_us", us(loop.cost.quantile(0.5))},
      {"tick_p99_us", us(loop.cost.quantile(0.99))},
      {"tick_p999_us", us(loop.cost.quantile(0.999))},
      {"tick_max_us", us(loop.cost.max())},
      {"snapshots_sent", number(c.snapshots_sent)},
      {"snapshots_per_second", per_second(c.snapshots_sent, loop)},
      {"snapshot_bytes", number(c.snapshot_bytes)},
      {"send_errors", number(c.send_errors)},
      {"send_p50_us", us(sending.cost.quantile(0.5))},
      {"send_p99_us", us(sending.cost.quantile(0.99))},
      {"to_wire_p50_us", us(sending.to_wire.quantile(0.5))},
      {"to_wire_p99_us", us(sending.to_wire.quantile(0.99))},
      {"events_dropped", number(c.events_dropped)},
      {"match_events_dropped", number(c.match_events_dropped)},
      {"journal_bytes", number(c.journal_bytes)},
      {"journal_dropped", number(c.journal_dropped)},
      {"results_kept", number(c.results_kept)},
      {"answers_kept", number(c.answers_kept)},
      {"clients_joined", number(c.control.joined)},
      {"clients_left", number(c.control.left)},
      {"clients_refused", number(c.control.refused)},
      {"control_bad", number(c.control.bad_messages)},
      {"control_timed_out", number(c.control.timed_out)},
      {"control_gave_up", number(c.control.gave_up)},
      {"control_slow_dropped", number(c.control.slow_dropped)},
      {"requests", number(c.control.requests)},
      {"requests_dropped", number(c.control.requests_dropped)},
      {"answers", number(c.control.answers)},
      {"answers_refused", number(c.control.answers_refused)},
      {"phones_joined", number(c.phones.joined)},
      {"phones_refused", number(c.phones.refused)},
      {"phones_bad", number(c.phones.bad_messages)},
      {"phones_timed_out", number(c.phones.timed_out)},
      {"phones_crowded_out", number(c.phones.crowded_out)},
      {"phones_slow_dropped", number(c.phones.slow_dropped)},
      {"phone_inputs", number(c.phones.inputs)},
      {"phone_inputs_dropped", number(c.phones.inputs_dropped)},
      {"phone_pulses", number(c.phones.pulses)},
      {"phone_pulses_dropped", number(c.phones.pulses_dropped)},
      {"haptic_pulses", number(c.haptic_pulses)},
      {"input_accepted", number(c.input.accepted)},
      {"input_bad", number(c.input.bad)},
      {"input_foreign", number(c.input.foreign)},
      {"input_stale", number(c.input.stale)},
      {"device_frames", number(devices.frames)},
      {"device_bad", number(devices.bad)},
      {"device_lost", number(devices.lost)},
      {"device_stale", number(devices.stale)},
      {"device_reopened", number(devices.reopened)},
      {"device_overflows", number(devices.overflows)},
      {"device_impossible", number(devices.impossible)},
      {"device_index_disagreements", number(index_disagreements(devices))},
      {"device_line_errors", number(devices.line_errors)},
      {"device_latency_mean_us", number(mean_latency_us(devices))},
      {"device_latency_max_us", number(devices.latency_max_us)},
  };
}

std::string quantiles(const Histogram& h) {
  return fmt::format("p50 {:.0f}  p99 {:.0f}  p99.9 {:.0f}  max {:.0f} us", us(h.quantile(0.5)),
                     us(h.quantile(0.99)), us(h.quantile(0.999)), us(h.max()));
}

std::string line(const DeviceCounters& device) {
  const cabinet::SourceCounters& c = device.counters;
  return fmt::format(
      "device     {}: {} frames, {} bad, {} lost, {} stale, {} times back, {} overflows, {} "
      "impossible motions, {} index marks that disagree, {} errors on the sensors' lines, from "
      "arrival to tick {} us (mean), {} us (max)",
      device.name, c.frames, c.bad, c.lost, c.stale, c.reopened, c.overflows, c.impossible,
      index_disagreements(c), c.line_errors, mean_latency_us(c), c.latency_max_us);
}

bool ends_with_csv(const std::string& path) {
  return path.size() >= 4 && path.compare(path.size() - 4, 4, ".csv") == 0;
}

constexpr const char* kPart = ".part";

std::string cannot_write(const std::string& path, int error) {
  return "cannot write " + path + ": " + std::strerror(error) +
         "; choose a file in a folder that can be written";
}

}  // namespace

std::string summary(const Server& server, const LoopStats& loop) {
  const Counters c = server.counters();
  const auto& score = server.match().view().score;
  std::string text;
  auto out = std::back_inserter(text);
  fmt::format_to(out, "score      {} : {}\n", score[0], score[1]);
  if (server.replay() != nullptr)
    fmt::format_to(out, "verdict    {}\n", server.replay()->verdict_sentence());
  fmt::format_to(out, "ticks      {} in {:.1f} s ({:.1f} a second), {} missed ({:.3f}%)\n", c.ticks,
                 loop.seconds, per_second(loop.ticks, loop), loop.missed,
                 100.0 * loop.missed_share());
  if (loop.lateness.count() > 0) fmt::format_to(out, "lateness   {}\n", quantiles(loop.lateness));
  fmt::format_to(out, "tick cost  {}\n", quantiles(loop.cost));
  if (c.snapshots_sent > 0) {
    fmt::format_to(out, "sending    {}, in another thread\n", quantiles(server.sending().cost));
  }
  fmt::format_to(out, "snapshots  {} sent, {} errors\n", c.snapshots_sent, c.send_errors);
  if (c.events_dropped > 0 || c.match_events_dropped > 0) {
    fmt::format_to(out, "events     {} dropped from snapshots, {} in the match\n", c.events_dropped,
                   c.match_events_dropped);
  }
  for (const DeviceCounters& device : server.devices()) {
    fmt::format_to(out, "{}\n", line(device));
  }
  fmt::format_to(out, "input      {} taken, {} bad, {} foreign, {} stale\n", c.input.accepted,
                 c.input.bad, c.input.foreign, c.input.stale);
  fmt::format_to(out, "clients    {} joined, {} left, {} rejected, {} bad, {} silent, {} slow\n",
                 c.control.joined, c.control.left, c.control.refused, c.control.bad_messages,
                 c.control.timed_out, c.control.slow_dropped);
  if (c.journal_bytes > 0 || c.journal_dropped > 0) {
    fmt::format_to(out, "journal    {} bytes, {} entries dropped\n", c.journal_bytes,
                   c.journal_dropped);
  }
  return text;
}

tl::expected<void, std::string> write_stats(const Server& server, const LoopStats& loop,
                                            const std::string& path) {
  const bool csv = ends_with_csv(path);
  std::string text = csv ? "name,value\n" : "{";
  const char* separator = "\n";
  for (const Figure& f : figures(server, loop)) {
    if (csv) {
      text += fmt::format("{},{:.10g}\n", f.name, f.value);
    } else {
      text += fmt::format("{}  \"{}\": {:.10g}", separator, f.name, f.value);
      separator = ",\n";
    }
  }
  if (!csv) text += "\n}\n";
  return write_whole(path, text);
}

tl::expected<void, std::string> can_write_whole(const std::string& path) {
  std::error_code error;
  const auto kind = std::filesystem::status(path, error).type();
  if (kind != std::filesystem::file_type::not_found &&
      kind != std::filesystem::file_type::regular) {
    return tl::unexpected("cannot write " + path +
                          ": it is not a regular file; choose another one");
  }
  const std::string part = path + kPart;
  std::FILE* file = std::fopen(part.c_str(), "wb");
  if (file == nullptr) return tl::unexpected(cannot_write(path, errno));
  std::fclose(file);
  std::remove(part.c_str());
  return {};
}

tl::expected<void, std::string> write_whole(const std::string& path, const std::string& text) {
  const std::string part = path + kPart;
  std::FILE* file = std::fopen(part.c_str(), "wb");
  bool ok = file != nullptr && std::fwrite(text.data(), 1, text.size(), file) == text.size();
  if (file != nullptr) ok = std::fclose(file) == 0 && ok;
  if (ok && std::rename(part.c_str(), path.c_str()) == 0) return {};
  const int error = errno;
  std::remove(part.c_str());
  return tl::unexpected(cannot_write(path, error));
}

}  // namespace server
