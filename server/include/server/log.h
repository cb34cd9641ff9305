// How server_core tells a person something: it is handed this, and never writes to a stream itself.
// Called from the control and the journal thread too; never from within a tick.
#pragma once

#include <functional>
#include <string>

namespace server {

enum class LogLevel { info, warning };
using Log = std::function<void(LogLevel, const std::string&)>;

}  // namespace server
