// The folder of automatic recordings, one per session of play: their names, how many are kept, and
// a summary of each for lists.
//
// A recording is named after the local time of its start: 2026-11-23_070542.sfr. Only files with
// such a name are deleted, the oldest first. A recording that a person keeps is never deleted: one
// with an empty file 2026-11-23_070542.sfr.keep beside it, or with any other name.
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
  std::uint64_t bytes = std::uint64_t{2} << 30;  // of all that may be deleted; a minute is 0.8 MB
  std::uint64_t bytes_of_one = std::uint64_t{256} << 20;  // five hours
};

// Makes the folder if it does not exist, deletes the recordings that exceed the limits together
// with the new one, and returns the path of the new one. now: seconds since 1970. The error is a
// sentence.
tl::expected<std::string, std::string> new_recording(const std::string& folder,
                                                     const RecordingLimits& limits,
                                                     std::time_t now);

// Summary of a recording, from its first and last bytes: the rest is not read.
struct RecordingSummary {
  enum class State {
    whole,       // with its end record
    cut_short,   // without its end record
    being_made,  // by a server that is running
    bad,         // see problem
  };
  std::string path;
  std::time_t began = 0;  // from its name, otherwise from the time of the last write
  std::uint64_t bytes = 0;
  State state = State::bad;
  std::string problem;  // a sentence that names the file and says what to do
  bool kept = false;
  int layout = 0, mode = 0;  // of the header
  wire::JournalStanding standing;
  std::array<std::string, 2> characters;  // chosen by the teams
  std::uint64_t ticks = 0;
};

// Never blocks: a pipe, a device or a folder is `bad` without being opened.
RecordingSummary summarise_recording(const std::string& path);
// True if a server is writing it.
bool is_being_recorded(const std::string& path);
// All *.sfr files of the folder, newest first. The error is a sentence; a missing folder is not an
// error.
tl::expected<std::vector<RecordingSummary>, std::string> list_recordings(const std::string& folder);

// Protects the recording from deletion, or removes the protection. The error is a sentence.
tl::expected<void, std::string> keep_recording(const std::string& path, bool keep);

// $XDG_DATA_HOME/space-foosball/recordings, or the same in ~/.local/share; empty if neither exists.
std::string recordings_folder();

}  // namespace server
