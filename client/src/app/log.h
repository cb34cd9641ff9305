// Messages on stderr, one line each.
#pragma once

#include <string>

namespace client {

void log_info(const std::string& sentence);
void log_warning(const std::string& sentence);

}  // namespace client
