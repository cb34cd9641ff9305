// A recording for somebody else: one file under a telling name, in a folder that is easily found.
#pragma once

#include <string>
#include <tl/expected.hpp>

#include "server/recordings.h"

namespace watch {

// "Space Foosball 2026-11-22 21.40 tall 5-3 small.sfr": when it began, teams, score.
std::string telling_name(const server::RecordingSummary& recording);
// Copies the recording as it is now into the folder, which is made, under that name, never over
// another file; and keeps the original. The copy's path, or a sentence.
tl::expected<std::string, std::string> share(const std::string& recording,
                                             const std::string& folder);

// "Space Foosball" in the folder of documents if there is one, else in the home.
std::string shared_folder();

}  // namespace watch
