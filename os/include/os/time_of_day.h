// Date and time in the format of files: UTC, such as 2026-11-22T23:59:59Z.
#pragma once

#include <cstdint>
#include <ctime>
#include <optional>
#include <string>
#include <string_view>

namespace os {

std::string utc_text(std::time_t time);
std::string utc_now();
// The inverse of utc_text(), in seconds since 1970; none for any other text.
std::optional<std::int64_t> utc_seconds(std::string_view text);

}  // namespace os
