// What a run was like: for a person to read, and as a file of figures.
#pragma once

#include <string>
#include <tl/expected.hpp>

#include "server/loop.h"
#include "server/server.h"

namespace server {

// Preconditions of both: Server::finish() was called.
std::string summary(const Server& server, const LoopStats& loop);

// A flat JSON object, or for a name that ends in .csv two columns, name and value. The error is a
// sentence.
tl::expected<void, std::string> write_stats(const Server& server, const LoopStats& loop,
                                            const std::string& path);

// Writes the file under another name first, so that whoever waits for it never sees half of it.
// can_write_whole: whether that would work, said before a run whose figures would be lost.
tl::expected<void, std::string> can_write_whole(const std::string& path);
tl::expected<void, std::string> write_whole(const std::string& path, const std::string& text);

}  // namespace server
