// A match: a pure step function of its state and its inputs. It uses no clock, file or socket, and
// no randomness except the given seed. The server, the replayer and the tests link the same code.
//
// Players operate the screens (paper, sections 5 and 5.1) with the rods: push any rod of a team to
// start, turn it to choose a character, push to confirm. See docs/rules.md.
//
// Threads: use a Match from one thread at a time. Different matches are independent.
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

// Requests of clients and messages from the server. The match applies them at the start of a tick,
// if the screen allows them.
struct Command {
  enum class Kind : std::uint8_t {
    push,              // the same as the push of a rod: starts, confirms, continues
    choose_character,  // team, value = character: index into MatchDesc::characters
    pause,             // value: 1 on, 0 off
    restart,           // back to the logo
    time_out,          // team requests one
    feed,              // training: team, value = feed_value(): serve to that man from now on
    seat,              // from the server: team, value 1: played by a computer, 0: by people
    touch,             // from the server: a person moved a rod during a demonstration match
    tune,  // value = index into kTuningFields, amount = new value; ignored if out of range or in a
           // challenge
    set_up,  // changes the game to setup, if playable(): at once on the logo and selection screens
             // and during a demonstration match, otherwise at the next logo
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
  goal,         // team scored; rod and man get the credit; own; value = ball's speed [m/s]
  serve,        // team; rod and man in front of whom the ball is placed
  dead_ball,    // no man could reach the ball
  ball_out,     // it left the table; team touched it last
  screen,       // value = the new Screen
  match_won,    // team won
  shot,         // rod and man; value = ball's speed [m/s], angle
  foul,         // of team; value = Foul
  time_out,     // of team begins
  set_won,      // team won a set, not the match
  match_drawn,  // the time ran out
};
inline constexpr int kEventKinds = 14;

struct Event {
  EventKind kind;
  std::uint8_t team = 0;  // of the man, the goal or the foul
  std::uint8_t rod = 0;
  std::uint8_t man = 0;
  double value = 0.0;
  vp::Vec3 point;      // in the table's frame (foosball/table.h) [m]: of a hit the contact point,
                       // otherwise the ball
  double angle = 0.0;  // shot, goal: direction of the ball relative to straight ahead for rod's
                       // team, seen from above, counter-clockwise positive [rad]
  bool own = false;    // goal: scored by a man of the team that conceded
};
inline constexpr std::size_t kMaxEventsPerStep = 128;  // further ones: MatchView::events_dropped

struct MatchDesc {
  Layout layout = Layout::tournament;
  std::uint64_t seed = 1;
  Rules rules{};
  Mode mode = Mode::match;
  Tuning tuning{};                                // initial values; commands change them
  Characters characters = built_in_characters();  // for the teams to choose from
};

// The challenge of a day. date: a number such as 20261122. It is the same match for everybody:
// tournament table, built-in characters, default tuning. The opponent: challenge_opponent()
// (foosball/computer_player.h).
MatchDesc challenge_of(std::uint32_t date);

// A slower ball is a pass or a dribble, not a shot.
inline constexpr double kShotSpeed = 4.0;  // [m/s]

// A shot: a ball that a man hit.
struct Shot {
  int team = 0, rod = 0, man = 0;
  double speed = 0.0;  // [m/s]
  double angle = 0.0;  // as Event::angle
};

// Everything that a renderer or a player may see.
struct MatchView {
  std::uint64_t tick = 0;
  Layout layout{};
  Mode mode{};
  RuleSet rule_set{};
  Rules rules;
  std::uint64_t challenge = 0;  // in a challenge: its date, which seeds the draw; otherwise 0
  GameSetup setup;              // the latest one requested
  bool setup_waits = false;     // setup differs from the current game and starts later
  Screen screen{};
  bool paused = false;
  std::array<int, kTeams> score{};
  int characters = 0;                    // number of characters to choose from
  std::array<int, kTeams> character{};   // chosen by each team: index of a character
  TeamBodies bodies;                     // of the men on the table
  std::array<bool, kTeams> confirmed{};  // on the selection screen
  double screen_seconds = 0.0;           // since the screen appeared [s]
  double play_seconds = 0.0;             // match clock [s]
  int last_scorer = 0;                   // team; on the ceremony and end screens
  Shot last_goal;                        // the credited man, and the ball's speed
  bool last_goal_own = false;            // scored by a man of the team that conceded
  Shot last_shot;
  std::array<int, kTeams> sets{};            // won
  std::array<int, kTeams> time_outs_left{};  // in this set
  double time_out_seconds = 0.0;             // remaining time of a time-out [s]; 0: none
  int time_out_team = 0;                     // that requested it
  bool timed = false;
  double seconds_left = 0.0;        // remaining in a timed set [s]
  bool golden_goal = false;         // the next goal decides
  int next_server = 0;              // team that serves next, or served last
  bool fouled = false;              // a foul occurred since the last goal or serve;
  Foul last_foul{};                 // its kind
  int last_foul_team = 0;           // and its team
  int possession_team = 0;          // team whose rod can reach the ball, or could reach it last
  double possession_seconds = 0.0;  // duration of this possession [s]
  std::array<bool, kTeams> computer{};
  bool attract = false;            // demonstration match: computers play both teams
  int rung = 0;                    // ladder: 0 .. kLadderRungs - 1
  int feed_rod = 0, feed_man = 0;  // training: the man who gets the serve
  bool ball_visible = false;       // in play, or in the goal after it scored
  bool ball_in_play = false;
  vp::Vec3 ball_position, ball_velocity;  // table's frame [m], [m/s]
  vp::SE3 ball_pose;                      // T_table_ball
  vp::Vec3 ball_spin;                     // table's frame [rad/s]
  // Indexed as TableSpec::rods. In the table's frame for both teams: slide along +y, angle
  // right-handed about +y, 0 with the men hanging down. Full turns count.
  std::array<RodState, kRods> rods{};
  ManStates men{};  // own angle of each man, within half a turn of his rod's angle
  Tuning tuning;
  // Counts since create(). They are not part of the match's state: not saved, restored or hashed.
  std::uint64_t events_dropped = 0;
  std::uint32_t matches_begun = 0;  // in all modes, demonstration matches included
};

class Match {
 public:
  // Rejects an invalid description with Errc::invalid_argument: an undefined layout, mode or rule;
  // goals outside 1 <= goals_to_win <= max_goals <= 99; sets outside 1 .. 9; a duration that is
  // negative, above 3600 s, NaN, or 0 where 0 has no meaning; a tuning or a character out of range;
  // no characters or more than kMaxCharacters. Any seed is valid.
  static vp::Expected<Match> create(const MatchDesc& desc);
  ~Match();
  Match(Match&&) noexcept;
  Match& operator=(Match&&) noexcept;

  void step(const TickInput& input);  // one kTick; non-finite targets count as not live
  const MatchView& view() const;
  std::span<const Event> events() const;  // of the last step

  // Appends the complete state: rules, screens, world. Always succeeds.
  void snapshot(std::vector<std::byte>& bytes) const;
  // Fails with Errc::bad_data and leaves the match unchanged if the bytes are truncated, corrupt or
  // of another version, if the saved match has another layout, other rules or other characters, or
  // if no match can be in the saved state. The seed may differ: the saved seed replaces this one.
  // Afterwards events() is empty and view() shows the saved match.
  vp::Expected<void> restore(std::span<const std::byte> bytes);
  std::uint64_t state_hash() const;

 private:
  struct Impl;
  explicit Match(std::unique_ptr<Impl> impl);
  std::unique_ptr<Impl> impl_;
};

// The state of a rod with the angle of one of its men.
RodState with_man(const RodState& rod, const ManState& man);

// Pose of a man in the world: origin on the rod's axis. state: of the rod, with the man's angle
// (with_man()).
vp::SE3 man_pose(const TableSpec& table, int rod, int man, const RodState& state);

}  // namespace foosball
