// Who played for each team of a match, and for how long. Counts ticks of play by name, so that a
// player who reconnects is the same one. Ticks that the computer plays for an absent player count
// for the computer. docs/rules.md, "When somebody leaves", defines the difference between leaving
// and joining late.
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
  // Number of names counted per team; above it, the one that played least is dropped.
  static constexpr std::size_t kNames = 16;
  // Names with less are omitted: joining for a moment does not make a player of the match.
  static constexpr double kMinShare = 0.01;

  void begin();  // starts another match
  // In each tick of play: call begin_tick(), then add() for each player, and keep_seat() for each
  // person whose rods the computer currently plays. They do not allocate.
  void begin_tick() { ++ticks_; }
  void add(int team, Kind kind, std::string_view name);
  void keep_seat(int team, std::string_view name);
  // Removed by others: did not leave voluntarily.
  void excuse(std::string_view name);

  // The players of the team, the one with the most play first; empty: none. return_ticks: total
  // absence that does not count as leaving.
  std::vector<results::Player> players(int team, std::uint64_t return_ticks) const;

 private:
  struct Row {
    Kind kind = Kind::person;
    std::array<char, wire::kMaxName + 1> name{};  // zero-terminated
    std::uint64_t ticks = 0;
    std::uint64_t first = 0, last = 0, seated = 0;  // ticks: first and last counted,
                                                    // last with a seat
    bool excused = false;
  };
  Row* find(int team, Kind kind, std::string_view name);
  bool has_left(const Row& row, std::uint64_t return_ticks) const;

  std::array<std::array<Row, kNames>, foosball::kTeams> rows_{};
  std::uint64_t ticks_ = 0;
};

}  // namespace server
