// TOML that strangers wrote, read by toml++ (marzer.github.io/tomlplusplus) without its undefined
// behaviour: Debian's version 3.3.0 asserts on some broken keys, and reaches a point that it calls
// unreachable on letters from U+0080 to U+FEFF between its tokens.
#pragma once

#include <string>
#include <string_view>

#define TOML_EXCEPTIONS 0
// It refuses as it should what it asserts on. Compile without NDEBUG what includes this, so that it
// does not take it for granted either.
#define TOML_ASSERT(expression) static_cast<void>(0)
#include <toml++/toml.h>

namespace profile {

// toml::parse() of a text whose letters from U+0080 to U+FEFF are moved out of its way, to
// U+F0080 and on, which is private use. Lines of errors are those of the text. Keys of thousands of
// parts, which overflow its stack, are an error.
toml::parse_result parse_toml(std::string_view text);

// A string, a key or a message of what parse_toml() returned, with the letters as they were.
std::string as_written(std::string_view parsed);

}  // namespace profile
