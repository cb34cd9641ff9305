// Runs a server on its loop until a reason to end.
#pragma once

#include <atomic>
#include <cstdint>
#include <optional>

#include "server/loop.h"
#include "server/server.h"

namespace server {

struct RunOptions {
  std::uint64_t ticks = 0;       // of the match; 0: no limit
  bool exit_when_empty = false;  // when the last client that joined has left
};

// The reason why a run ended.
enum class RunEnd : std::uint8_t { stopped, time_over, empty, replay_over };
wire::Sentence to_sentence(RunEnd end);

// Also detects overload: clients get a notice while more than 5% of a second's ticks are missed.
RunEnd run(Server& server, TickLoop& loop, const RunOptions& options,
           const std::atomic<bool>& stop);

}  // namespace server
