// The folder of recordings that are made without being asked for, one of each time that the game is
// played: their names, how many are kept, and what a list says of each.
//
// A recording has the name of the moment at which it began, local time: 2026-11-23_070542.sfr. Only
// files with such a name are ever dropped, the oldest first. Dropped is never one that a person
// keeps: one with an empty file 2026-11-23_070542.sfr.keep beside it, or of any other name.
#pragma once

#include <array>
#include <cstdint>
#include <ctime>
#include <optional>
#include <string>
#include <tl/expected.hpp>
#include <vector>

#include "wire/journal.h"

namespace server {

struct RecordingLimits {
  std::size_t count = 200;
  std::uint64_t bytes = std::uint64_t{2} << 30;  // of all that may be dropped; a minute is 0.8 MB
  std::uint64_t bytes_of_one = std::uint64_t{256} << 20;  // five hours
};

// Makes the folder if there is none, drops what is too much with the one that is to come, and names
// that. now: seconds since 1970. The error is a sentence.
tl::expected<std::string, std::string> new_recording(const std::string& folder,
                                                     const RecordingLimits& limits,
                                                     std::time_t now);

// What its first and last bytes say of a recording: the rest is not read.
struct RecordingSummary {
  enum class State {
    whole,       // to its end
    cut_short,   // without its end
    being_made,  // by a server that runs now
    bad,         // see problem
  };
  std::string path;
  std::time_t began = 0;  // by its name, else when it was last written
  std::uint64_t bytes = 0;
  State state = State::bad;
  std::string problem;  // a sentence that names the file and what to do
  bool kept = false;
  int layout = 0, mode = 0;  // of the header
  wire::JournalStanding standing;
  std::array<std::string, 2> characters;  // that were chosen
  std::uint64_t ticks = 0;
};

// Never waits: a pipe, a device or a folder is bad without being opened.
RecordingSummary summarise_recording(const std::string& path);
// A server writes it now.
bool is_being_recorded(const std::string& path);
// All *.sfr of the folder, newest first. The error is a sentence; no folder is no error.
tl::expected<std::vector<RecordingSummary>, std::string> list_recordings(const std::string& folder);

// Keeps it from being dropped, or no longer. The error is a sentence.
tl::expected<void, std::string> keep_recording(const std::string& path, bool keep);

// $XDG_DATA_HOME/space-foosball/recordings, or in ~/.local/share; empty without either.
std::string recordings_folder();

}  // namespace server
