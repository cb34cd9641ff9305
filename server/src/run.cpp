#include "server/run.h"

namespace server {
namespace {

// Looks once a second at how many ticks were missed in it.
class OverloadWatch {
 public:
  void look(Server& server, const LoopStats& stats) {
    if (stats.ticks - ticks_ < kWindow) return;
    const std::uint64_t missed = stats.missed - missed_;
    ticks_ = stats.ticks;
    missed_ = stats.missed;
    const bool overloaded = missed > kTolerated;
    if (overloaded == told_) return;
    told_ = overloaded;
    if (overloaded) {
      server.warn(Server::Topic::overload,
                  "the physics server cannot keep up: end other programs on its machine");
    } else {
      server.clear(Server::Topic::overload, "the physics server keeps up again");
    }
  }

 private:
  static constexpr std::uint64_t kWindow = 1000;  // ticks
  static constexpr std::uint64_t kTolerated = 50;
  std::uint64_t ticks_ = 0, missed_ = 0;
  bool told_ = false;
};

std::optional<RunEnd> reason_to_end(const Server& server, const RunOptions& options,
                                    const LoopStats& stats, const std::atomic<bool>& stop) {
  if (stop.load(std::memory_order_relaxed)) return RunEnd::stopped;
  if (server.replay_over()) return RunEnd::replay_over;
  if (options.ticks != 0 && stats.ticks + 1 >= options.ticks) return RunEnd::time_over;
  if (options.exit_when_empty && server.clients_ever() > 0 && server.clients() == 0) {
    return RunEnd::empty;
  }
  return std::nullopt;
}

}  // namespace

const char* to_text(RunEnd end) {
  switch (end) {
    case RunEnd::stopped:
      return "the server was stopped";
    case RunEnd::time_over:
      return "the time is over";
    case RunEnd::empty:
      return "everybody has left";
    case RunEnd::replay_over:
      return "the recording is over";
  }
  return "";
}

RunEnd run(Server& server, TickLoop& loop, const RunOptions& options,
           const std::atomic<bool>& stop) {
  OverloadWatch overload;
  std::optional<RunEnd> end;
  loop.run([&](std::int64_t now_us, const LoopStats& stats) {
    server.tick(now_us);
    overload.look(server, stats);
    end = reason_to_end(server, options, stats, stop);
    return !end;
  });
  return *end;
}

}  // namespace server
