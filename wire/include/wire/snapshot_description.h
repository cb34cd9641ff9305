// The only description of a snapshot. wire/description.h defines its elements.
#pragma once

#include <limits>

#include "wire/description.h"
#include "wire/limits.h"
#include "wire/snapshot.h"

namespace wire {

inline constexpr std::uint64_t kSnapshotMagic = 0x4E534653;  // "SFSN"
inline constexpr std::uint64_t kSnapshotVersion = 4;

// 15 um over +-2 m: a table is 1.2 m long, and a ball that has left it matters no further out.
inline constexpr Fixed kPosition{"position", 18, 0x1p-16, "m", "x, y, z in the world"};
inline constexpr Rotation kOrientation{"orientation", 15, "quaternion x, y, z, w, body to world"};
// Up to 64 m/s: the fastest observed shots stay below 20 m/s, the simulation's ball below 40 m/s.
inline constexpr Fixed kLinearVelocity{"linear_velocity", 16, 0x1p-9, "m/s",
                                       "of the body's origin, in the world"};
// A spun rod reaches about 200 rad/s; a ball that it grazes has a radius ten times smaller.
inline constexpr Fixed kManSpin{"angular_velocity", 16, 0x1p-7, "rad/s", "in the world"};
inline constexpr Fixed kBallSpin{"angular_velocity", 16, 0x1p-4, "rad/s", "in the world"};

template <class Codec, class Pose>
void describe_pose(Codec& codec, Pose& pose, const Fixed& spin) {
  codec.vector(kPosition, pose.position);
  codec.rotation(kOrientation, pose.orientation);
  codec.vector(kLinearVelocity, pose.linear_velocity);
  codec.vector(spin, pose.angular_velocity);
}

template <class Codec, class Rod>
void describe_rod(Codec& codec, Rod& rod) {
  codec.fixed(Fixed{"slide", 20, 0x1p-18, "m", "along the rod, as simulated"}, rod.slide);
  codec.wrapped(Wrapped{"angle", 24, "about the rod, as simulated; wraps at 256 turns"}, rod.angle);
  codec.fixed(Fixed{"slide_rate", 16, 0x1p-9, "m/s", ""}, rod.slide_rate);
  codec.fixed(Fixed{"angle_rate", 16, 0x1p-7, "rad/s", ""}, rod.angle_rate);
  codec.integer(Integer{"status", 2, kRodStatusCount - 1, "", "0 absent, 1 live, 2 held"},
                rod.status);
  codec.integer(Integer{"source", 3, kRodSourceCount - 1, "",
                        "0 none, 1 cabinet, 2 client, 3 computer, 4 replay"},
                rod.source);
}

template <class Codec, class Man>
void describe_man(Codec& codec, Man& man) {
  codec.integer(Integer{"rod", 3, kRods - 1, "", "from -x to +x"}, man.rod);
  codec.integer(Integer{"man", 3, kMenOnRod - 1, "", "along the rod"}, man.man);
  describe_pose(codec, man.body, kManSpin);
}

inline constexpr Fixed kShotAngle{
    "angle", 12, 0x1p-9, "rad",
    "direction of a shot, from straight ahead, counter-clockwise positive"};

template <class Codec, class Event>
void describe_event(Codec& codec, Event& event) {
  codec.integer(Integer{"id", 32, std::numeric_limits<std::uint32_t>::max(), "", "counts up"},
                event.id);
  codec.integer(Integer{"kind", 4, kEventKindCount - 1, "",
                        "0 man hit, 1 wall hit, 2 field hit, 3 goal, 4 serve, 5 dead ball, "
                        "6 ball out, 7 screen, 8 match won, 9 shot, 10 foul, 11 time-out, "
                        "12 set won, 13 match drawn"},
                event.kind);
  codec.integer(Integer{"team", 1, kTeamCount - 1, "", "of the man, the goal or the foul"},
                event.team);
  codec.integer(Integer{"rod", 3, kRods - 1, "", "of the man"}, event.rod);
  codec.integer(Integer{"man", 3, kMenOnRod - 1, "", ""}, event.man);
  codec.fixed(Fixed{"value", 21, 0x1p-14, "",
                    "impulse of a hit [N s], speed of a shot or goal [m/s], the new screen, the "
                    "foul's reason"},
              event.value);
  codec.vector(Fixed{"point", 18, 0x1p-16, "m", "x, y, z in the world"}, event.point);
  codec.fixed(kShotAngle, event.angle);
  codec.flag(Flag{"own", "goal: by a man of the team that conceded"}, event.own);
}

template <class Codec, class Shot>
void describe_shot(Codec& codec, Shot& shot) {
  codec.integer(Integer{"team", 1, kTeamCount - 1, "", ""}, shot.team);
  codec.integer(Integer{"rod", 3, kRods - 1, "", ""}, shot.rod);
  codec.integer(Integer{"man", 3, kMenOnRod - 1, "", ""}, shot.man);
  codec.fixed(Fixed{"speed", 16, 0x1p-10, "m/s", "", false}, shot.speed);
  codec.fixed(kShotAngle, shot.angle);
}

// Rules and what they have decided.
template <class Codec, class S>
void describe_rules_state(Codec& codec, S& s) {
  codec.integer(
      Integer{"mode", 2, kModeCount - 1, "", "0 match, 1 training, 2 challenge, 3 ladder"}, s.mode);
  codec.integer(Integer{"rule_set", 1, kRuleSetCount - 1, "", "0 arcade, 1 ITSF"}, s.rule_set);
  codec.array(Group{"sets", "won by team 0 and 1"}, s.sets, [&](auto& sets) {
    codec.integer(Integer{"won", 4, 15, "", ""}, sets);
  });
  codec.array(Group{"time_outs_left", "of team 0 and 1, in this set"}, s.time_outs_left,
              [&](auto& left) {
                codec.integer(Integer{"left", 8, 255, "", ""}, left);
              });
  codec.fixed(Fixed{"time_out_seconds", 16, 0x1p-4, "s", "left of a time-out; 0: none", false},
              s.time_out_seconds);
  codec.integer(Integer{"time_out_team", 1, kTeamCount - 1, "", "that asked for it"},
                s.time_out_team);
  codec.flag(Flag{"timed", ""}, s.timed);
  codec.flag(Flag{"golden_goal", "the next goal decides"}, s.golden_goal);
  codec.fixed(Fixed{"seconds_left", 16, 0x1p-4, "s", "of a timed set", false}, s.seconds_left);
  codec.integer(
      Integer{"next_server", 1, kTeamCount - 1, "", "team that serves next, or served last"},
      s.next_server);
  codec.flag(Flag{"fouled", "since the last goal"}, s.fouled);
  codec.integer(Integer{"last_foul", 3, kFoulCount - 1, "",
                        "0 possession, 1 spin, 2 jarring, 3 technical, 4 time-out, 5 serve"},
                s.last_foul);
  codec.integer(Integer{"last_foul_team", 1, kTeamCount - 1, "", ""}, s.last_foul_team);
  codec.integer(
      Integer{"possession_team", 1, kTeamCount - 1, "", "team that has the ball, or had it last"},
      s.possession_team);
  codec.fixed(Fixed{"possession_seconds", 16, 0x1p-4, "s", "since when it has possession", false},
              s.possession_seconds);
  codec.array(Group{"computer", "plays team 0 and 1"}, s.computer, [&](auto& is) {
    codec.flag(Flag{"is", ""}, is);
  });
  codec.flag(Flag{"attract", "nobody plays: computers play a demonstration match"}, s.attract);
  codec.integer(Integer{"rung", 3, kRungCount - 1, "", "of the ladder"}, s.rung);
  codec.integer(
      Integer{"feed_rod", 3, kRods - 1, "", "training: the rod to which the ball is served"},
      s.feed_rod);
  codec.integer(Integer{"feed_man", 3, kMenOnRod - 1, "", ""}, s.feed_man);
  codec.flag(Flag{"ball_visible", "in play, or in a goal after scoring"}, s.ball_visible);
  codec.group(Group{"last_goal", "credited to"}, [&] { describe_shot(codec, s.last_goal); });
  codec.flag(Flag{"last_goal_own", "by a man of the team that conceded"}, s.last_goal_own);
  codec.group(Group{"last_shot", ""}, [&] { describe_shot(codec, s.last_shot); });
}

template <class Codec, class S>
void describe_match_state(Codec& codec, S& s) {
  codec.integer(Integer{"layout", 1, kLayoutCount - 1, "", "0 paper, 1 tournament"}, s.layout);
  codec.integer(
      Integer{"screen", 3, kScreenCount - 1, "", "0 logo, 1 selection, 2 play, 3 ceremony, 4 end"},
      s.screen);
  codec.flag(Flag{"paused", ""}, s.paused);
  codec.flag(Flag{"ball_in_play", ""}, s.ball_in_play);
  codec.array(Group{"score", "of team 0 and 1"}, s.score, [&](auto& goals) {
    codec.integer(Integer{"goals", 8, 255, "", ""}, goals);
  });
  codec.array(Group{"character", "of team 0 and 1"}, s.character, [&](auto& character) {
    codec.integer(Integer{"index", 4, kMaxCharacterCount - 1, "", "into Characters"}, character);
  });
  codec.array(Group{"confirmed", "of team 0 and 1"}, s.confirmed, [&](auto& is) {
    codec.flag(Flag{"is", ""}, is);
  });
  codec.integer(Integer{"last_scorer", 1, kTeamCount - 1, "", "team"}, s.last_scorer);
  codec.fixed(Fixed{"screen_seconds", 24, 0x1p-10, "s", "since the screen appeared", false},
              s.screen_seconds);
  codec.fixed(Fixed{"play_seconds", 24, 0x1p-10, "s", "match clock", false}, s.play_seconds);
}

template <class Codec, class S>
void describe_snapshot(Codec& codec, S& s) {
  constexpr std::uint64_t kAny = std::numeric_limits<std::uint64_t>::max();
  codec.constant(Constant{"magic", 32, kSnapshotMagic, "bytes \"SFSN\""});
  codec.constant(Constant{"version", 16, kSnapshotVersion, ""});
  codec.layout_hash(LayoutHash{"layout_hash", "of this table"});
  codec.integer(Integer{"session", 64, kAny, "", "names this run of the server"}, s.session);
  codec.integer(Integer{"sequence", 64, kAny, "", "of the datagram"}, s.sequence);
  codec.integer(Integer{"tick", 64, kMaxTick, "", "of the simulation"}, s.tick);
  codec.integer(Integer{"send_time_us", 63, kAny >> 1, "us", "server's monotonic clock"},
                s.send_time_us);
  describe_match_state(codec, s);
  describe_rules_state(codec, s);
  codec.group(Group{"ball", ""}, [&] { describe_pose(codec, s.ball, kBallSpin); });
  codec.array(Group{"rods", "from -x to +x"}, s.rods, [&](auto& rod) { describe_rod(codec, rod); });
  codec.list(List{"men", 6, kMaxMen, "every man on the table"}, s.men,
             [&](auto& man) { describe_man(codec, man); });
  codec.list(List{"events", 4, kMaxEvents, "oldest first; each is repeated in 8 snapshots"},
             s.events, [&](auto& event) { describe_event(codec, event); });
  codec.checksum(Checksum{"crc", ""});
}

}  // namespace wire
