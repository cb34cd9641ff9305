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

// A stranger's name as others see it: clean_text of at most kMaxName bytes, without characters that
// are not seen or that turn the direction of what follows (Unicode's Default_Ignorable_Code_Point,
// line and paragraph separators, the blank braille pattern), every space a plain one, and none at
// its ends or behind another. Two names that differ only in such characters become one. Letters of
// different scripts that look alike stay. What has nothing left is "unnamed".
std::string clean_name(std::string_view name);

}  // namespace wire
