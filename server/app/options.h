// The command line of space-foosball-server.
#pragma once

#include <optional>
#include <string>
#include <tl/expected.hpp>
#include <vector>

#include "server/loop.h"
#include "server/run.h"
#include "server/server.h"

namespace app {

struct Options {
  foosball::MatchDesc match;
  std::array<bool, foosball::kTeams> computer{};
  server::NetworkOptions network;
  server::RunOptions run;
  server::LoopOptions loop;
  std::vector<std::string> devices;
  std::string calibration, record, replay, results, ready_file, stats_file;
  bool overwrite = false, await_client = false, quiet = false;
};

// What to print, and the exit code, when there is nothing to run: --help, or a bad value.
struct Leave {
  int exit_code;
  std::string text;
};

tl::expected<Options, Leave> parse(int argc, const char* const* argv);

}  // namespace app
