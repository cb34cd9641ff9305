// Counts of ticks that are part of a match's state.
#pragma once

#include <cstdint>

#include "foosball/table.h"

namespace foosball {

// No match lasts longer [ticks]: 8900 years. Below 2^48, as a snapshot's tick must be, and with
// room for more matches after it.
inline constexpr std::uint64_t kMaxTicks = std::uint64_t{1} << 47;
constexpr std::uint64_t ticks_of(double seconds) {
  const double ticks = seconds / kTick;
  const auto whole = static_cast<std::uint64_t>(ticks);
  return ticks - static_cast<double>(whole) < 0.5 ? whole : whole + 1;  // the nearest
}

// One more. A saved match may have any count up to the most, so that counts stop there: what is
// restored can always be saved and restored again.
inline void count_tick(std::uint64_t& ticks) {
  if (ticks < kMaxTicks) ++ticks;
}

}  // namespace foosball
