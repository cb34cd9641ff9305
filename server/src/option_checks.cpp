#include "server/option_checks.h"

#include <charconv>
#include <cmath>
#include <cstdlib>

namespace server {

std::optional<std::uint64_t> parse_seed(const std::string& text) {
  std::uint64_t value = 0;
  const char* end = text.data() + text.size();
  const auto [stopped_at, error] = std::from_chars(text.data(), end, value);
  return error == std::errc{} && stopped_at == end ? std::optional(value) : std::nullopt;
}

std::string check_seed(const std::string& text) {
  return parse_seed(text) ? ""
                          : "\"" + text + "\" is not a whole number from 0 to 18446744073709551615";
}

std::string check_not_nan(const std::string& text) {
  return std::isnan(std::strtod(text.c_str(), nullptr)) ? "\"" + text + "\" is not a number" : "";
}

}  // namespace server
