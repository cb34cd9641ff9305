// What the small numbers in the messages mean. wire knows neither foosball nor cabinet: the server,
// which knows all three, asserts that every value agrees with theirs (server/src/match_record.cpp).
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
};

// Wish::kind and JournalCommand::kind.
enum class WishKind : std::uint8_t { push = 0, choose_character = 1, pause = 2, restart = 3 };

// RodSnapshot::status.
enum class RodStatus : std::uint8_t { absent = 0, live = 1, held = 2 };

// RodSnapshot::source.
enum class RodSource : std::uint8_t { none = 0, cabinet = 1, client = 2, computer = 3, replay = 4 };

// The fields are bytes, since what was received is checked before it is believed.
template <class Enum>
constexpr std::uint8_t number(Enum value) {
  return static_cast<std::uint8_t>(value);
}

}  // namespace wire
