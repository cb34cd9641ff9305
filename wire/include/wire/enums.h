// The enumerations of the messages. wire does not know foosball or cabinet. The server, which knows
// all three, asserts that all values agree (server/src/match_record.cpp).
#pragma once

#include <cstdint>

namespace wire {

// Snapshot::screen.
enum class Screen : std::uint8_t { logo = 0, selection = 1, play = 2, ceremony = 3, end = 4 };

// EventSnapshot::kind.
enum class EventKind : std::uint8_t {
  man_hit = 0,
  wall_hit = 1,
  field_hit = 2,
  goal = 3,
  serve = 4,
  dead_ball = 5,
  ball_out = 6,
  screen = 7,
  match_won = 8,
  shot = 9,
  foul = 10,
  time_out = 11,
  set_won = 12,
  match_drawn = 13,
};

// Snapshot::rule_set, mode, last_foul, and EventSnapshot::value of a foul.
enum class RuleSet : std::uint8_t { arcade = 0, itsf = 1 };
enum class Mode : std::uint8_t { match = 0, training = 1, challenge = 2, ladder = 3 };
enum class Foul : std::uint8_t {
  possession = 0,
  spin = 1,
  jarring = 2,
  technical = 3,
  time_out = 4,
  serve = 5,
};

// MatchRequest::kind and JournalCommand::kind; only the server issues seat, touch and set_up.
enum class RequestKind : std::uint8_t {
  push = 0,
  choose_character = 1,
  pause = 2,
  restart = 3,
  time_out = 4,
  feed = 5,
  seat = 6,
  touch = 7,
  tune = 8,
  set_up = 9,
};

// Knock::role, Welcome::role, Seat::role: the rights of a client. A host may do everything; a
// player may change what concerns its team, and vote; a watcher may only watch.
enum class Role : std::uint8_t { watcher = 0, player = 1, host = 2 };

// DeviceReport::state. missing: not present; refused: present, but cannot be opened; silent: open,
// but sends nothing; garbled: sends data without a valid frame; over: a recording at its end.
enum class DeviceState : std::uint8_t {
  missing = 0,
  refused = 1,
  silent = 2,
  garbled = 3,
  live = 4,
  over = 5,
};

// RodSnapshot::status, DeviceRod::status.
enum class RodStatus : std::uint8_t { absent = 0, live = 1, held = 2 };

// RodSnapshot::source.
enum class RodSource : std::uint8_t { none = 0, cabinet = 1, client = 2, computer = 3, replay = 4 };

// The structs hold bytes, since received values are checked before use.
template <class Enum>
constexpr std::uint8_t number(Enum value) {
  return static_cast<std::uint8_t>(value);
}

}  // namespace wire
