// Validators of command-line values, for CLI11's check(): empty, or an error message.
#pragma once

#include <cstdint>
#include <optional>
#include <string>

namespace server {

// A non-negative integer, digits only, that fits the type. CLI11 instead accepts -1, and takes a
// number that is too large for the maximum.
std::optional<std::uint64_t> parse_seed(const std::string& text);
std::string check_seed(const std::string& text);

// In addition to CLI::Range(), which accepts "nan".
std::string check_not_nan(const std::string& text);

}  // namespace server
