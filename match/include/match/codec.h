// A result as one line of text, for checkpoint files and messages between ranks:
//   winner score0 score1 state_hash index:count ... #check
// with the nonzero counts of Statistics, in the order of Statistics::visit.
#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "match/game.h"

namespace match {

std::string encode_result(const GameResult& result);
// Returns none if the line is truncated or was changed.
std::optional<GameResult> decode_result(std::string_view line);

}  // namespace match
