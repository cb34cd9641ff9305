// Shares a recording: copies it as one file with a descriptive name to a folder that is easy to
// find.
#pragma once

#include <string>
#include <tl/expected.hpp>

#include "server/recordings.h"

namespace watch {

// "Space Foosball 2026-11-22 21.40 tall 5-3 small.sfr": time of its start, teams, score.
std::string telling_name(const server::RecordingSummary& recording);
// Copies the recording in its present state into the folder under that name; creates the folder,
// and never overwrites a file. Also marks the original to be kept. Returns the copy's path, or a
// sentence.
tl::expected<std::string, std::string> share(const std::string& recording,
                                             const std::string& folder);

// "Space Foosball" in the documents folder if there is one, otherwise in the home folder.
std::string shared_folder();

}  // namespace watch
