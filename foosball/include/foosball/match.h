// A match as a pure step function of its state and its inputs: no clock, no file, no socket, no
// randomness but the seed it is handed. The server, the replayer and the tests all link this one.
//
// Screens (paper, sections 5 and 5.1) are worked with the rods themselves: push any rod of a team
// to start, spin it to choose a character, push to confirm. See docs/rules.md.
//
// Threads: a Match is used by one thread at a time; different matches are independent.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "foosball/rod_motion.h"
#include "foosball/table.h"
#include "vphysics/error.h"
#include "vphysics/lie.h"

namespace foosball {

using RodTargets = std::array<RodTarget, kRods>;

// Wishes of a client, applied at the start of a tick if the screen allows them.
struct Command {
  enum class Kind : std::uint8_t {
    push,              // as a rod pushed: starts, confirms, goes on
    choose_character,  // team, value = character
    pause,             // value 1 on, 0 off
    restart,           // back to the logo
  };
  Kind kind;
  std::uint8_t team = 0;
  std::uint8_t value = 0;
};

struct TickInput {
  RodTargets rods;
  std::span<const Command> commands;
};

enum class Screen : std::uint8_t { logo, selection, play, ceremony, end };
inline constexpr int kScreens = 5;

enum class EventKind : std::uint8_t {
  man_hit,    // value = impulse [N s]
  wall_hit,   // value = impulse
  field_hit,  // value = impulse
  goal,       // team scored
  serve,
  dead_ball,  // no man reached the ball in time: served again
  ball_out,   // left the table
  screen,     // value = the new Screen
  match_won,  // team won
};
inline constexpr int kEventKinds = 9;

struct Event {
  EventKind kind;
  std::uint8_t team = 0;  // of the man or the goal
  std::uint8_t rod = 0;   // man_hit
  std::uint8_t man = 0;   // man_hit
  double value = 0.0;
  vp::Vec3 point;  // in the table's frame (foosball/table.h) [m]: a hit's contact, else the ball
};
inline constexpr std::size_t kMaxEventsPerStep = 128;  // MatchView::events_dropped counts the rest

struct Rules {
  int goals_to_win = 5;  // "to 5, last game by two, max 8" (ITSF)
  int max_goals = 8;
  double dead_ball_seconds = 6.0;  // without a touch and almost at rest
  double ceremony_seconds = 2.5;
  double end_seconds = 6.0;

  bool operator==(const Rules&) const = default;
};

struct MatchDesc {
  Layout layout = Layout::tournament;
  std::uint64_t seed = 1;
  Rules rules;
};

// All that a renderer or a player may see.
struct MatchView {
  std::uint64_t tick = 0;
  Layout layout{};
  Screen screen{};
  bool paused = false;
  std::array<int, kTeams> score{};
  std::array<int, kTeams> character{};
  std::array<bool, kTeams> confirmed{};  // on the selection screen
  double screen_seconds = 0.0;           // since the screen came up [s]
  double play_seconds = 0.0;             // match clock [s]
  int last_scorer = 0;                   // team, on ceremony and end
  bool ball_in_play = false;
  vp::Vec3 ball_position, ball_velocity;  // table's frame [m], [m/s]
  vp::SE3 ball_pose;                      // T_table_ball
  vp::Vec3 ball_spin;                     // table's frame [rad/s]
  // By TableSpec::rods. In the table's frame for both teams: slide along +y, angle right-handed
  // about +y, 0 with the men hanging, full turns counted.
  std::array<RodState, kRods> rods{};
  // Since create(): not of the match's state, so neither saved, restored nor hashed.
  std::uint64_t events_dropped = 0;
};

class Match {
 public:
  // Refuses with Errc::invalid_argument what cannot be played: a layout that is none, goals not
  // 1 <= goals_to_win <= max_goals <= 99, a duration that is not above 0 and at most 3600 s (NaN
  // included). Any seed will do.
  static vp::Expected<Match> create(const MatchDesc& desc);
  ~Match();
  Match(Match&&) noexcept;
  Match& operator=(Match&&) noexcept;

  void step(const TickInput& input);  // one kTick; targets that are not finite count as not live
  const MatchView& view() const;
  std::span<const Event> events() const;  // of the last step

  // Appends the whole state: rules, screens, world. Refuses nothing.
  void snapshot(std::vector<std::byte>& bytes) const;
  // Refuses with Errc::bad_data, and is then unchanged: bytes that are truncated, corrupt or of
  // another version, and a match of another layout or other rules than this one's. The seed may
  // differ. events() is empty afterwards; view() is that of the saved match.
  vp::Expected<void> restore(std::span<const std::byte> bytes);
  std::uint64_t state_hash() const;

 private:
  struct Impl;
  explicit Match(std::unique_ptr<Impl> impl);
  std::unique_ptr<Impl> impl_;
};

// Pose of a man in the world: origin on the rod's axis.
vp::SE3 man_pose(const TableSpec& table, int rod, int man, const RodState& state);

}  // namespace foosball
