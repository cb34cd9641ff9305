// Checks of values on the command line, for CLI11's check(): empty, or what is wrong with the text.
#pragma once

#include <cstdint>
#include <optional>
#include <string>

namespace server {

// A whole number of digits alone, which fits: CLI11 takes -1 and what is too large for the
// greatest.
std::optional<std::uint64_t> parse_seed(const std::string& text);
std::string check_seed(const std::string& text);

// Beside CLI::Range(), which lets "nan" through.
std::string check_not_nan(const std::string& text);

}  // namespace server
