// The command line of space-foosball-server.
#pragma once

#include <optional>
#include <string>
#include <tl/expected.hpp>
#include <vector>

#include "server/loop.h"
#include "server/recordings.h"
#include "server/run.h"
#include "server/server.h"

namespace app {

// A mouse of this machine and the rod that it controls, 0..7.
struct Mouse {
  std::string name, path;
  int rod;
};

struct Options {
  foosball::MatchDesc match;
  std::array<bool, foosball::kTeams> computer{};
  bool computer_fills = false;
  foosball::PlayerSpec computer_player{};
  std::uint32_t challenge_date = 0;  // given; 0: today's
  server::NetworkOptions network;
  server::AccessOptions access;
  server::ControlLimits limits;
  server::PhoneOptions phones;
  bool haptics = true;
  server::RunOptions run;
  server::LoopOptions loop;
  std::vector<std::string> devices;
  std::vector<Mouse> mice;
  std::string recordings;  // folder of automatic recordings
  server::RecordingLimits recording_limits;
  std::string calibration, record, replay, results, ready_file, stats_file;
  bool no_questionnaire = false;
  bool password_was_made = false;  // generated for this run, and must be shown
  bool overwrite = false, await_client = false, quiet = false;
};

// What to print, and the exit code, if there is nothing to run: --help, or an invalid value.
struct Leave {
  int exit_code;
  std::string text;
};

tl::expected<Options, Leave> parse(int argc, const char* const* argv);

}  // namespace app
