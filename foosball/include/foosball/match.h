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

#include "foosball/feed.h"
#include "foosball/game_setup.h"
#include "foosball/rod_motion.h"
#include "foosball/rules.h"
#include "foosball/table.h"
#include "foosball/tuning.h"
#include "vphysics/error.h"
#include "vphysics/lie.h"

namespace foosball {

using RodTargets = std::array<RodTarget, kRods>;
using ManStates = std::array<std::array<ManState, kMaxMenOnRod>, kRods>;

// Requests of a client and news from the server, applied at the start of a tick if the screen
// allows them.
struct Command {
  enum class Kind : std::uint8_t {
    push,              // as a rod pushed: starts, confirms, goes on
    choose_character,  // team, value = character: index into MatchDesc::characters
    pause,             // value 1 on, 0 off
    restart,           // back to the logo
    time_out,          // team asks for one
    feed,              // training: team, value = feed_value(): serve to that man from now on
    seat,              // from the server: team, value 1: a computer plays it, 0: people do
    touch,             // from the server: a hand has moved a rod while computers show a match
    tune,              // value = index into kTuningFields, amount = the new value, if in its range;
                       // not in a challenge
    set_up,            // another game: setup, if playable(); at the logo and the selection, and
                       // while computers show a match, at once; else when the logo comes next
  };
  Kind kind;
  std::uint8_t team = 0;
  std::uint8_t value = 0;
  double amount = 0.0;  // tune
  GameSetup setup{};    // set_up
};
inline constexpr int kCommandKinds = 10;

struct TickInput {
  RodTargets rods;
  std::span<const Command> commands;
};

enum class Screen : std::uint8_t { logo, selection, play, ceremony, end };
inline constexpr int kScreens = 5;

enum class EventKind : std::uint8_t {
  man_hit,      // value = impulse [N s]
  wall_hit,     // value = impulse
  field_hit,    // value = impulse
  goal,         // team scored; rod and man are credited with it; own; value = ball's speed [m/s]
  serve,        // team; rod and man before whom the ball lies
  dead_ball,    // within nobody's reach
  ball_out,     // left the table; team touched it last
  screen,       // value = the new Screen
  match_won,    // team won
  shot,         // rod and man; value = ball's speed [m/s], angle
  foul,         // team's; value = Foul
  time_out,     // team's begins
  set_won,      // team won a set, not the match
  match_drawn,  // the time is over
};
inline constexpr int kEventKinds = 14;

struct Event {
  EventKind kind;
  std::uint8_t team = 0;  // of the man, the goal or the foul
  std::uint8_t rod = 0;
  std::uint8_t man = 0;
  double value = 0.0;
  vp::Vec3 point;  // in the table's frame (foosball/table.h) [m]: a hit's contact, else the ball
  double angle = 0.0;  // shot, goal: of the ball's way from straight ahead for rod's team, seen
                       // from above, counter-clockwise positive [rad]
  bool own = false;    // goal: by a man of the team that conceded
};
inline constexpr std::size_t kMaxEventsPerStep = 128;  // MatchView::events_dropped counts the rest

struct MatchDesc {
  Layout layout = Layout::tournament;
  std::uint64_t seed = 1;
  Rules rules{};
  Mode mode = Mode::match;
  Tuning tuning{};                                // at the start; commands change it
  Characters characters = built_in_characters();  // that teams choose from
};

// The challenge of a day: date as a number such as 20261122. The same match for everybody: of the
// tournament table, the built-in characters and the default tuning. Whom it is played against:
// challenge_opponent() (foosball/computer_player.h).
MatchDesc challenge_of(std::uint32_t date);

// A ball sent off slower is a pass or a dribble.
inline constexpr double kShotSpeed = 4.0;  // [m/s]

// A ball that a man has sent off.
struct Shot {
  int team = 0, rod = 0, man = 0;
  double speed = 0.0;  // [m/s]
  double angle = 0.0;  // as Event::angle
};

// All that a renderer or a player may see.
struct MatchView {
  std::uint64_t tick = 0;
  Layout layout{};
  Mode mode{};
  RuleSet rule_set{};
  Rules rules;                  // all of them
  std::uint64_t challenge = 0;  // in a challenge: what it is drawn from, its date
  GameSetup setup;              // as chosen last;
  bool setup_waits = false;     // it is another game than the one in hand
  Screen screen{};
  bool paused = false;
  std::array<int, kTeams> score{};
  int characters = 0;                    // that there are to choose from
  std::array<int, kTeams> character{};   // chosen, of those
  TeamBodies bodies;                     // of the men on the table
  std::array<bool, kTeams> confirmed{};  // on the selection screen
  double screen_seconds = 0.0;           // since the screen came up [s]
  double play_seconds = 0.0;             // match clock [s]
  int last_scorer = 0;                   // team, on ceremony and end
  Shot last_goal;                        // who is credited with it, and the ball's speed
  bool last_goal_own = false;            // by a man of the team that conceded
  Shot last_shot;
  std::array<int, kTeams> sets{};            // won
  std::array<int, kTeams> time_outs_left{};  // in this set
  double time_out_seconds = 0.0;             // left of a time-out; 0: none
  int time_out_team = 0;                     // that asked for it
  bool timed = false;
  double seconds_left = 0.0;        // of a timed set
  bool golden_goal = false;         // the next goal decides
  int next_server = 0;              // team that has the ball next, or had it last
  bool fouled = false;              // since the last goal or serve:
  Foul last_foul{};                 // why,
  int last_foul_team = 0;           // and whose
  int possession_team = 0;          // within whose reach the ball is or was last
  double possession_seconds = 0.0;  // for so long
  std::array<bool, kTeams> computer{};
  bool attract = false;            // nobody plays: computers show a match
  int rung = 0;                    // ladder: 0 .. kLadderRungs - 1
  int feed_rod = 0, feed_man = 0;  // training: to whom the ball is served
  bool ball_visible = false;       // in play, or in the goal it went into
  bool ball_in_play = false;
  vp::Vec3 ball_position, ball_velocity;  // table's frame [m], [m/s]
  vp::SE3 ball_pose;                      // T_table_ball
  vp::Vec3 ball_spin;                     // table's frame [rad/s]
  // By TableSpec::rods. In the table's frame for both teams: slide along +y, angle right-handed
  // about +y, 0 with the men hanging, full turns counted.
  std::array<RodState, kRods> rods{};
  ManStates men{};  // each man's own angle, within half a turn of his rod's
  Tuning tuning;
  // Since create(): not of the match's state, so neither saved, restored nor hashed.
  std::uint64_t events_dropped = 0;
  std::uint32_t matches_begun = 0;  // of whatever mode, those for show too
};

class Match {
 public:
  // Refuses with Errc::invalid_argument what cannot be played: a layout, mode or rule that is none,
  // goals not 1 <= goals_to_win <= max_goals <= 99, sets not 1 .. 9, a duration that is negative,
  // above 3600 s or NaN, or 0 where 0 has no meaning, a tuning out of its ranges, characters out of
  // theirs, none or more than kMaxCharacters.
  // Any seed will do.
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
  // another version, a match of another layout, other rules or other characters than this
  // one's, and a state that no match is ever in. The seed may differ: it is the saved one's from
  // then on. events() is empty afterwards; view() is that of the saved match.
  vp::Expected<void> restore(std::span<const std::byte> bytes);
  std::uint64_t state_hash() const;

 private:
  struct Impl;
  explicit Match(std::unique_ptr<Impl> impl);
  std::unique_ptr<Impl> impl_;
};

// A rod as one of its men follows it: with his angle.
RodState with_man(const RodState& rod, const ManState& man);

// Pose of a man in the world, whose rod, as he follows it, has this state: origin on its axis.
vp::SE3 man_pose(const TableSpec& table, int rod, int man, const RodState& state);

}  // namespace foosball
