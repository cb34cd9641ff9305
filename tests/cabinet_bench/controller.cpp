#include "controller.h"

#include <algorithm>

namespace cabinet_bench {

std::string name_of(Board board) {
  switch (board) {
    case Board::mega32u4:
      return "32u4";
    case Board::mega2560:
      return "2560";
    case Board::rp2040:
      return "rp2040";
  }
  return {};
}

std::optional<Board> board_named(const std::string& name) {
  const auto found = std::ranges::find(kBoards, name, name_of);
  return found == kBoards.end() ? std::nullopt : std::optional(*found);
}

double usual_counts_per_mm(Board board) {
  return board == Board::rp2040 ? 78.74 : 8;  // 2000 cpi; a mouse's resolution 3
}

std::unique_ptr<Controller> power_on(Board board) {
  return board == Board::rp2040 ? power_on_rp2040() : power_on_avr(board);
}

}  // namespace cabinet_bench
