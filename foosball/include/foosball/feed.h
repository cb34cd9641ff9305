// Training: the man who receives the serve, encoded as the value of a command.
#pragma once

#include <cstdint>

#include "foosball/table.h"

namespace foosball {

// Command::value of a feed: 0 <= man < kMaxMenOnRod.
constexpr std::uint8_t feed_value(Line line, int man) {
  return static_cast<std::uint8_t>(static_cast<int>(line) * 8 + man);
}
inline constexpr int kFeedValues = 32;

}  // namespace foosball
