// Who has played each team of a match, and for how much of it: ticks of play counted by name, so
// that a player who connects anew is the same one. What the computer plays for somebody who is away
// is the computer's. Who leaves is told from who came late: docs/rules.md, "When somebody leaves".
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "foosball/match.h"
#include "results/match_result.h"
#include "wire/control.h"

namespace server {

class Lineup {
 public:
  enum class Kind : std::uint8_t { person, computer, cabinet };  // cabinet: hands without a name
  // Of whom it keeps count in a team; where more come, the one who played least is forgotten.
  static constexpr std::size_t kNames = 16;
  // Who has played less is left out: a moment's join is not a player of the match.
  static constexpr double kLeastShare = 0.01;

  void begin();  // another match
  // In each tick of play: begin_tick(), then add() for each who plays, and keep_seat() for each
  // person whose rods the computer plays meanwhile. Take no memory.
  void begin_tick() { ++ticks_; }
  void add(int team, Kind kind, std::string_view name);
  void keep_seat(int team, std::string_view name);
  // Put out by others: has not left of his own will.
  void excuse(std::string_view name);

  // Those who played most of the team first; empty: nobody has. return_ticks: for so long in all a
  // person may be away without having left.
  std::vector<results::Player> players(int team, std::uint64_t return_ticks) const;

 private:
  struct Row {
    Kind kind = Kind::person;
    std::array<char, wire::kMaxName + 1> name{};  // ended by a zero
    std::uint64_t ticks = 0;
    std::uint64_t first = 0, last = 0, seated = 0;  // ticks: the first and the last that were
                                                    // counted, the last with a seat
    bool excused = false;
  };
  Row* find(int team, Kind kind, std::string_view name);
  bool has_left(const Row& row, std::uint64_t return_ticks) const;

  std::array<std::array<Row, kNames>, foosball::kTeams> rows_{};
  std::uint64_t ticks_ = 0;
};

}  // namespace server
