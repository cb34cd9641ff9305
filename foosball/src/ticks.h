// Counts of ticks in a match's state.
#pragma once

#include <cstdint>

#include "foosball/table.h"

namespace foosball {

// Maximum length of a match [ticks]: 8900 years. It is below 2^48, the limit of a snapshot's tick,
// so that more matches fit after it.
inline constexpr std::uint64_t kMaxTicks = std::uint64_t{1} << 47;
constexpr std::uint64_t ticks_of(double seconds) {
  const double ticks = seconds / kTick;
  const auto whole = static_cast<std::uint64_t>(ticks);
  return ticks - static_cast<double>(whole) < 0.5 ? whole : whole + 1;  // rounded to nearest
}

// Increments up to the maximum. A saved match may hold any count up to it, so counting stops there:
// a restored state can always be saved and restored again.
inline void count_tick(std::uint64_t& ticks) {
  if (ticks < kMaxTicks) ++ticks;
}

}  // namespace foosball
