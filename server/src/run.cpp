#include "server/run.h"

#include "overload_watch.h"

namespace server {
namespace {

void report(Server& server, OverloadWatch::Change change) {
  switch (change) {
    case OverloadWatch::Change::overloaded:
      server.warn(Server::Topic::overload, wire::make_sentence<wire::SentenceId::cannot_keep_up>());
      break;
    case OverloadWatch::Change::keeps_up_again:
      server.clear(Server::Topic::overload, "the physics server runs in real time again");
      break;
    case OverloadWatch::Change::none:
      break;
  }
}

std::optional<RunEnd> reason_to_end(const Server& server, const RunOptions& options,
                                    const std::atomic<bool>& stop) {
  if (stop.load(std::memory_order_relaxed)) return RunEnd::stopped;
  if (server.replay_over()) return RunEnd::replay_over;
  if (options.ticks != 0 && server.ticks() >= options.ticks) return RunEnd::time_over;
  if (options.exit_when_empty && server.clients_ever() > 0 && server.clients() == 0) {
    return RunEnd::empty;
  }
  return std::nullopt;
}

}  // namespace

wire::Sentence to_sentence(RunEnd end) {
  using wire::SentenceId, wire::make_sentence;
  switch (end) {
    case RunEnd::stopped:
      return make_sentence<SentenceId::server_stopped>();
    case RunEnd::time_over:
      return make_sentence<SentenceId::time_is_over>();
    case RunEnd::empty:
      return make_sentence<SentenceId::everybody_left>();
    case RunEnd::replay_over:
      return make_sentence<SentenceId::recording_over>();
  }
  return {};
}

RunEnd run(Server& server, TickLoop& loop, const RunOptions& options,
           const std::atomic<bool>& stop) {
  OverloadWatch overload;
  std::optional<RunEnd> end;
  loop.run([&](std::int64_t now_us, const LoopStats& stats) {
    server.tick(now_us);
    report(server, overload.look(stats.ticks, stats.missed));
    end = reason_to_end(server, options, stop);
    return !end;
  });
  return *end;
}

}  // namespace server
