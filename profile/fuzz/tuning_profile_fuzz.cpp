// Fuzzes parse_tuning() with untrusted files. Accepted values must survive a round trip.
#include <cstdlib>
#include <string_view>

#include "profile/tuning_profile.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string_view text(reinterpret_cast<const char*>(data), size);
  const auto tuning = profile::parse_tuning(text, "fuzz.toml");
  if (!tuning) return tuning.error().empty() ? (std::abort(), 1) : 0;
  const auto again = profile::parse_tuning(profile::format_tuning(*tuning), "again.toml");
  if (!again || !(*again == *tuning)) std::abort();
  return 0;
}
