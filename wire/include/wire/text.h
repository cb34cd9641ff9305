// Text from untrusted sources, to be shown and logged: UTF-8 without control characters, of limited
// length.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>

namespace wire {

// Truncates text at a character boundary within max_bytes. Replaces control characters and bytes
// that are not UTF-8 with '?'.
std::string clean_text(std::string_view text, std::size_t max_bytes);

// True if clean_text would change nothing.
bool is_clean_text(std::string_view text, std::size_t max_bytes);

// A person's name as shown to others: clean_text of at most kMaxName bytes. Removes characters that
// are invisible or change the text direction (Unicode's Default_Ignorable_Code_Point, line and
// paragraph separators, the blank braille pattern). Replaces every space character with a plain
// space; removes spaces at the ends and repeated ones. Two names that differ only in such
// characters become equal. Similar letters of different scripts are kept. An empty result becomes
// "unnamed".
std::string clean_name(std::string_view name);

}  // namespace wire
