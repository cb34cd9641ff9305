// What can be watched, and who has won: the recordings of a folder and the matches of a file of
// results, newest first.
#pragma once

#include <string>
#include <vector>

#include "render/hud_replay.h"

namespace watch {

struct Library {
  client::ReplayList list;
  std::vector<std::string> paths;  // by row; empty: nothing to watch
};

// Either may be empty. What cannot be read is said in the list's message.
Library read_library(const std::string& folder, const std::string& results);

}  // namespace watch
