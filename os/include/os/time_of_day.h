// The date and time as files have them: UTC, such as 2026-11-22T23:59:59Z.
#pragma once

#include <cstdint>
#include <ctime>
#include <optional>
#include <string>
#include <string_view>

namespace os {

std::string utc_text(std::time_t time);
std::string utc_now();
// Seconds since 1970 of what utc_text() gives; none of any other text.
std::optional<std::int64_t> utc_seconds(std::string_view text);

}  // namespace os
