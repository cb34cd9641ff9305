// The command line of space-foosball-match.
#pragma once

#include <cstdint>
#include <string>
#include <tl/expected.hpp>
#include <vector>

#include "foosball/character.h"
#include "foosball/table.h"
#include "foosball/tuning.h"
#include "match/character_study.h"
#include "match/player.h"
#include "match/training.h"

namespace app {

enum class Mode {
  matches,
  report,
  stuck_balls,
  sprt,
  round_robin,
  balance,
  study,
  vary,
  traits,
  screen,
  train
};

struct Options {
  Mode mode = Mode::matches;
  std::vector<std::string> players{match::default_player(),
                                   match::default_player()};  // home and away; new and old; ...
  foosball::Layout layout = foosball::Layout::tournament;
  foosball::Tuning tuning{};
  foosball::Characters character_list = foosball::built_in_characters();
  std::uint64_t seed = 1;
  std::uint64_t matches = 100;
  std::uint64_t max_matches = 2000;  // of a sequential test
  std::uint64_t samples = 64;        // of a study
  match::VariedNumber varied{};      // of --vary
  match::TrainPlan training{};       // of --screen and --train, without base
  std::string write;                 // file for the trained values
  double max_minutes = 10.0;         // of a match
  double elo0 = 0.0, elo1 = 20.0, alpha = 0.05, beta = 0.05;
  int jobs = 1;
  std::string record, checkpoint, csv, json, results;
  bool quiet = false;
};

// Exits the program: text for stdout (0) or one sentence for stderr (2).
struct Leave {
  int exit_code;
  std::string text;
};
tl::expected<Options, Leave> parse(int argc, const char* const* argv);

}  // namespace app
