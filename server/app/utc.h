// The date and time, as results and the challenge of the day have it.
#pragma once

#include <array>
#include <ctime>
#include <string>

namespace app {

// Such as 2026-11-22T23:59:59Z.
inline std::string utc_now() {
  const std::time_t now = std::time(nullptr);
  std::tm parts{};
  ::gmtime_r(&now, &parts);
  std::array<char, 32> text;
  return {text.data(), std::strftime(text.data(), text.size(), "%Y-%m-%dT%H:%M:%SZ", &parts)};
}

}  // namespace app
