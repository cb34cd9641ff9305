// Log callback of server_core, which never writes to a stream itself. The control and the journal
// thread call it too. It is never called from within a tick.
#pragma once

#include <functional>
#include <string>

namespace server {

enum class LogLevel { info, warning };
using Log = std::function<void(LogLevel, const std::string&)>;

}  // namespace server
