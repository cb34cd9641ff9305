// A result as one line of text, for checkpoint files and messages between ranks:
//   winner score0 score1 state_hash index:count ... #check
// with the counts of Statistics that are not 0, in the order of Statistics::visit.
#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "match/game.h"

namespace match {

std::string encode_result(const GameResult& result);
// Nothing, if the line is not whole or was changed.
std::optional<GameResult> decode_result(std::string_view line);

}  // namespace match
