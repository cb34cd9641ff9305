// Reads untrusted TOML with toml++ (marzer.github.io/tomlplusplus), and avoids its undefined
// behaviour: Debian's version 3.3.0 asserts on some broken keys, and reaches a point marked
// unreachable on letters from U+0080 to U+FEFF between tokens.
#pragma once

#include <string>
#include <string_view>

#define TOML_EXCEPTIONS 0
// Without the assertions it rejects those keys correctly. Compile users of this header without
// NDEBUG, so that the compiler does not assume the asserted conditions either.
#define TOML_ASSERT(expression) static_cast<void>(0)
#include <toml++/toml.h>

namespace profile {

// toml::parse() of a text in which letters from U+0080 to U+FEFF are moved to U+F0080 and up, a
// private use area. Lines of errors refer to the original text. Keys with thousands of parts, which
// would overflow the stack, are an error.
toml::parse_result parse_toml(std::string_view text);

// A string, a key or a message from parse_toml() with the original letters.
std::string as_written(std::string_view parsed);

}  // namespace profile
