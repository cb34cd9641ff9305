// The results of a run: a summary to read, and a file of statistics.
#pragma once

#include <string>
#include <tl/expected.hpp>

#include "server/loop.h"
#include "server/server.h"

namespace server {

// Precondition of both: Server::finish() was called.
std::string summary(const Server& server, const LoopStats& loop);

// Writes a flat JSON object; if the name ends in .csv, two columns, name and value. The error is a
// sentence.
tl::expected<void, std::string> write_stats(const Server& server, const LoopStats& loop,
                                            const std::string& path);

// write_whole writes the file under a temporary name and renames it, so that a waiting reader never
// sees a partial file. can_write_whole checks before a run that this would work, since a failure
// afterwards would lose the statistics.
tl::expected<void, std::string> can_write_whole(const std::string& path);
tl::expected<void, std::string> write_whole(const std::string& path, const std::string& text);

}  // namespace server
