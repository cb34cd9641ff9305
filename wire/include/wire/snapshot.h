// The snapshot: one UDP datagram per tick, from the server to every listener.
// wire/snapshot_description.h describes its content; the encoder, the decoder, the layout hash and
// docs/protocol.md are derived from it.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "wire/limits.h"

namespace wire {

inline constexpr std::size_t kMaxDatagram = 1200;
inline constexpr int kMaxMen = 32;
inline constexpr int kMaxBalls = 1;
inline constexpr int kMaxEvents = 8;

struct PoseVelocity {
  std::array<float, 3> position{};               // world [m]
  std::array<float, 4> orientation{0, 0, 0, 1};  // unit quaternion x y z w, body to world
  std::array<float, 3> linear_velocity{};        // world, of the body's origin [m/s]
  std::array<float, 3> angular_velocity{};       // world [rad/s]
};

struct ManState {
  std::uint8_t rod = 0;  // 0..7
  std::uint8_t man = 0;  // 0..4 along the rod
  PoseVelocity body;
};

struct RodSnapshot {
  float slide = 0, angle = 0;  // as simulated [m], [rad] (unbounded, 24 bit at 1/65536 revolution)
  float slide_rate = 0, angle_rate = 0;  // [m/s], [rad/s]
  std::uint8_t status = 0;               // RodStatus (wire/enums.h)
  std::uint8_t source = 0;               // RodSource
};

struct EventSnapshot {
  std::uint32_t id = 0;   // counts up; an event is repeated in 8 snapshots, against packet loss
  std::uint8_t kind = 0;  // EventKind
  std::uint8_t team = 0, rod = 0, man = 0;
  float value = 0;
  std::array<float, 3> point{};
  float angle = 0;   // of a shot, or of the ball in a goal [rad]
  bool own = false;  // goal
};

// A ball that a man has shot.
struct ShotSnapshot {
  std::uint8_t team = 0, rod = 0, man = 0;
  float speed = 0;  // [m/s]
  float angle = 0;  // from straight ahead for the team, counter-clockwise positive [rad]
};

struct Snapshot {
  std::uint64_t session = 0;
  std::uint64_t sequence = 0;           // of the datagram
  std::uint64_t tick = 0;               // of the simulation
  std::int64_t send_time_us = 0;        // server's monotonic clock
  std::uint8_t layout = 0, screen = 0;  // foosball::Layout, Screen
  bool paused = false, ball_in_play = false;
  std::array<std::uint8_t, 2> score{};
  std::array<std::uint8_t, 2> character{};
  std::array<bool, 2> confirmed{};
  std::uint8_t last_scorer = 0;
  std::uint8_t mode = 0, rule_set = 0;  // Mode, RuleSet (wire/enums.h)
  std::array<std::uint8_t, 2> sets{};   // won
  std::array<std::uint8_t, 2> time_outs_left{};
  float time_out_seconds = 0;  // remaining time of a time-out; 0: none
  std::uint8_t time_out_team = 0;
  bool timed = false, golden_goal = false;
  float seconds_left = 0;        // of a timed set
  std::uint8_t next_server = 0;  // team
  bool fouled = false;           // since the last goal; the next two: reason, team
  std::uint8_t last_foul = 0, last_foul_team = 0;
  std::uint8_t possession_team = 0;
  float possession_seconds = 0;
  std::array<bool, 2> computer{};           // the computer plays the team
  bool attract = false;                     // nobody plays: computers play a demonstration match
  std::uint8_t rung = 0;                    // of the ladder
  std::uint8_t feed_rod = 0, feed_man = 0;  // training: the man to whom the ball is served
  bool ball_visible = false;                // in play, or in the goal that it entered
  ShotSnapshot last_goal, last_shot;
  bool last_goal_own = false;
  float screen_seconds = 0, play_seconds = 0;
  PoseVelocity ball;
  std::array<RodSnapshot, kRods> rods{};
  std::vector<ManState> men;          // <= kMaxMen
  std::vector<EventSnapshot> events;  // <= kMaxEvents, oldest first
};

// Writes one datagram. Returns its size, or 0 if out is too small. The size is <= kMaxDatagram for
// every snapshot within the stated counts; further men and events are omitted. Clamps values to
// their field's range; values that are not finite become 0. out: kMaxDatagram bytes.
std::size_t encode_snapshot(const Snapshot& snapshot, std::span<std::byte> out);

// Returns false unless magic, version, layout hash, every range, the exact length and the checksum
// are valid; snapshot is then unspecified but valid. Never reads outside in; never asserts.
bool decode_snapshot(std::span<const std::byte> in, Snapshot& snapshot);

std::uint32_t snapshot_layout_hash();

// A rod's angle is sent modulo 256 revolutions. Returns the equivalent angle nearest to `near`.
double unwrap_angle(double wrapped, double near);

}  // namespace wire
