// Text from a stranger, to be shown and logged: UTF-8 without control characters, of limited
// length.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>

namespace wire {

// text cut to whole characters within max_bytes; what is not UTF-8, and control characters, become
// '?'.
std::string clean_text(std::string_view text, std::size_t max_bytes);

// clean_text would change nothing.
bool is_clean_text(std::string_view text, std::size_t max_bytes);

}  // namespace wire
