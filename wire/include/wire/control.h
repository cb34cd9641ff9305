// The TCP control messages, both ways. Each is a FlatBuffers table in wire/control.fbs, verified
// before it is read; these are the plain structs that the processes use.
//
// Framing: u32 length (little endian, of what follows), then the FlatBuffers buffer. A length above
// kMaxControlMessage ends the connection before anything is allocated.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <variant>
#include <vector>

#include "wire/characters.h"
#include "wire/limits.h"

namespace wire {

inline constexpr std::uint16_t kControlVersion = 7;
inline constexpr std::size_t kMaxControlMessage = 64 * 1024;  // bytes

inline constexpr std::size_t kMaxName = 64;   // bytes: name, multicast
inline constexpr std::size_t kMaxText = 200;  // bytes: reason, text
inline constexpr std::size_t kMaxUrl = 128;   // bytes: url

inline constexpr std::uint8_t kWatchOnly = 255;
inline constexpr std::size_t kMaxSeats = 64;
inline constexpr std::size_t kMaxFame = 8;
inline constexpr std::size_t kMaxDevices = 16;

// By rod: who plays it. Empty: the one whose name the seat has, or nobody.
using RodPlayers = std::array<std::string, kRods>;

// Client to server, first message from another machine: the exchange of wire/password_exchange.h.
// What follows its Challenge, both ways, is a sealed stream (wire/seal.h) of messages.
struct Knock {
  std::uint16_t version = kControlVersion;
  std::uint8_t role = 0;  // Role (wire/enums.h), asked for; each has its password
  std::array<std::byte, 16> sid{};
  std::array<std::byte, 32> share{};
};
// Server to client: its answer.
struct Challenge {
  std::array<std::byte, 32> share{};
};

// Client to server, first message at one machine, or the first sealed one; within 5 s of
// connecting.
struct Hello {
  std::uint16_t version = kControlVersion;
  std::uint32_t snapshot_layout = 0;  // snapshot_layout_hash()
  std::string name;                   // at most 64 bytes of UTF-8
  std::uint16_t udp_port = 0;         // where this client listens for snapshots
  std::uint8_t team = kWatchOnly;     // 0, 1: wants to drive rods of that team
  std::uint8_t rods = 0;              // which, bit 0 at -x; 0: all of the team that nobody has
  std::uint64_t session = 0;          // with ticket: of the Welcome before, to have the same seat
  std::uint64_t ticket = 0;           // again; 0: a new one
};

// Server to client: accepted.
struct Welcome {
  std::uint64_t session = 0;     // names this run of the server
  std::uint64_t token = 0;       // the client's secret: for its inputs, and the ticket of its seat
  std::uint16_t udp_port = 0;    // where the server takes input datagrams
  std::uint32_t tick_us = 1000;  // 1..kMaxTickUs (wire/limits.h)
  std::uint8_t layout = 0;       // foosball::Layout
  std::uint8_t team = kWatchOnly;  // granted
  std::string multicast;           // group address, or empty for unicast to udp_port
  std::uint16_t multicast_port = 0;
  std::uint8_t rods = 0;                     // granted, bit 0 at -x
  std::uint8_t role = 0;                     // Role, granted
  std::uint32_t client = 0;                  // the client's number, and its keys' id
  std::array<std::byte, 32> input_key{};     // seals what the client sends
  std::array<std::byte, 32> snapshot_key{};  // seals snapshots; with multicast, everybody's, id 0
};

// Client to server: these rods from now on. The answer is a Roster, or a Notice that says why not.
struct Claim {
  std::uint8_t rods = 0;           // bit 0 at -x; 0: gives up those it has, and watches
  std::uint8_t team = kWatchOnly;  // plays for it from now on; kWatchOnly: for the one it has
};

// Client to server: who the people at this client are. A name that another has there already, or
// that results have for others, gets a number behind it: the Roster tells which.
struct Names {
  std::string name;    // of the client's seat
  RodPlayers players;  // of its rods
};

// Client to server: this player is to be put out of the match. A host's word is done; of players it
// is a vote, begun or agreed to. A Notice of kKickAnswerTopic says why it is neither.
struct Kick {
  std::uint32_t client = 0;  // of the Roster; never 0
};

// Server to client: the tuning values of the match, on joining and after each change.
struct Tuning {
  std::array<double, kTuningCount> values{};  // finite, in the order of foosball/tuning.h
};

// What is played: asked for by a client, of which the host's word counts, and told by the server on
// joining and after each change. It takes effect at the logo and the selection; in play it waits
// for the next match, or for a restart. What the mode does not leave to be chosen is asked for as 0
// (foosball/game_setup.h). A Notice of kGameAnswerTopic says why a request is not done.
struct Game {
  std::uint8_t mode = 0, rule_set = 0;  // Mode, RuleSet (wire/enums.h)
  std::uint8_t goals = 0;               // that win a set; 0: as the rules have it
  std::uint8_t sets = 0;                // best of; 0: as the rules have it
  std::uint32_t match_ms = 0;           // of play of a set; 0: no limit
  bool change_sides = false;
  // Of the computer players. Told where the mode decides: of the challenge's opponent; the
  // ladder's is known by its rung, and 0 here.
  std::uint8_t level = 0;  // from 1
  std::uint8_t style =
      0;  // from 1: wall, shooter, passer, gambler; 0: the one that suits the level
  std::uint32_t date = 0;  // told: of a challenge; asked for: 0, for it is today's
  bool waits = false;      // told: it is another game than the one in hand
  bool operator==(const Game&) const = default;
};

// One who has a place at the table.
struct Seat {
  std::uint32_t client = 0;
  std::string name;
  std::uint8_t team = kWatchOnly, rods = 0, role = 0;
  bool away = false;  // was lost: the seat is kept for a while
};
// Server to client: all who have a place, after each change.
struct Roster {
  std::vector<Seat> seats;  // <= kMaxSeats
  RodPlayers players;
};

// Server to client: not accepted; the connection closes.
struct Refusal {
  enum class Code : std::uint8_t {
    version,
    layout,
    full,
    bad_message,
    team_taken,
    password,     // none was given, or the wrong one
    not_allowed,  // by the host's options
  };
  Code code = Code::version;
  std::string reason;  // one sentence that says what to do
};

// Client to server: a foosball::Command.
struct MatchRequest {
  std::uint8_t kind = 0;  // RequestKind (wire/enums.h)
  std::uint8_t team = 0, value = 0;
  double amount = 0.0;  // tune
};

// Either way; the other answers with the same id.
struct Ping {
  std::uint64_t id = 0;
};
struct Pong {
  std::uint64_t id = 0;
};

// Server to client: something a person should read ("cabinet /dev/ttyACM0 unplugged: its rods
// hold").
struct Notice {
  enum class Level : std::uint8_t { info, warning, cleared };
  Level level = Level::info;
  std::uint32_t topic = 0;  // a later notice of the same topic replaces this one
  std::string text;
};

// Either way, before closing on purpose.
struct Bye {
  std::string reason;
};

// Server to client, when a match that is kept was won: who played these rods in it may answer the
// questionnaire at this client.
struct Questionnaire {
  std::uint32_t match = 0;  // counted from 1 since the server's start
  std::uint8_t rods = 0;    // bit 0 at -x; never 0
};

// Client to server: what one player answered. A Notice of kAnswersTopic says why it is not kept.
struct Answers {
  std::uint32_t match = 0;  // of the Questionnaire
  std::uint8_t rods = 0;    // that this player had, of one team; never 0
  // By question (docs/questionnaire.md): 1 strongly disagree .. kMaxScore strongly agree; 0: none.
  std::array<std::uint8_t, kQuestionCount> scores{};
};

// What a team did in a match, as it is kept.
struct TeamReport {
  std::uint32_t shots = 0, shots_on_target = 0, saves = 0, passes = 0, own_goals = 0;
  float possession = 0.0f;                    // since its last touch [s]; finite, as all here
  float rating = 0.0f, rating_change = 0.0f;  // its players' mean Elo after the match; by it
  float fastest_shot = 0.0f;                  // [m/s]; 0: it did not shoot, or not known
};
struct Fame {
  std::string name;
  float rating = 0.0f;
  std::uint32_t matches = 0, wins = 0;
  float fastest_shot = 0.0f;                 // of the player's teams [m/s]; 0: not known
  std::uint32_t shots_faced = 0, saves = 0;  // of the player's teams: on target; of those
};
// Server to client, on joining and after each match that is kept: the last one, and who plays best.
struct Report {
  std::uint32_t match = 0;  // counted from 1 since the server's start; 0: none yet
  std::array<TeamReport, kTeamCount> teams{};
  std::vector<Fame> fame;  // <= kMaxFame, best first
};

// Server to client, to players and hosts, on joining: where phones join as pairs of rods
// (wire/phone_message.h). Who knows it may play.
struct Phones {
  std::string url;
};

// Client to server, of a host: what its controllers and mice do now. Answered by Devices, at most
// every 20 ms.
struct DeviceQuery {};

// A rod as a device has it.
struct DeviceRod {
  std::uint8_t status = 0;                         // RodStatus (wire/enums.h)
  std::int64_t slide_counts = 0, spin_counts = 0;  // of its sensor, since it was first heard
  float slide = 0.0f, angle = 0.0f;                // calibrated [m], [rad]; finite
  bool operator==(const DeviceRod&) const = default;
};
// A controller or a mouse at the server's machine. The counters are since the server's start.
struct DeviceReport {
  std::string name;        // at most 64 bytes
  std::uint8_t state = 0;  // DeviceState (wire/enums.h)
  std::uint64_t frames = 0, lost = 0, bad = 0, stale = 0, reopened = 0;
  std::uint64_t overflows = 0, impossible = 0, line_errors = 0;  // told by or of its sensors
  // From a frame's arrival at the machine to the tick that takes it in: of how many it is known,
  // their sum, the longest [us].
  std::uint64_t stamped = 0, latency_sum_us = 0, latency_max_us = 0;
  std::array<DeviceRod, kRods> rods;
  bool operator==(const DeviceReport&) const = default;
};
// Server to client: answers a DeviceQuery.
struct Devices {
  std::int64_t time_us = 0;           // the server's clock
  std::vector<DeviceReport> devices;  // <= kMaxDevices
};

using ControlMessage =
    std::variant<Hello, Welcome, Refusal, MatchRequest, Ping, Pong, Notice, Bye, Knock, Challenge,
                 Claim, Roster, Tuning, Characters, Questionnaire, Answers, Report, Kick, Game,
                 Names, Phones, DeviceQuery, Devices>;

// Appends the framed message. Texts are cut to their caps; in them, what is not UTF-8 and control
// characters become '?'. Numbers out of range are the caller's mistake: the reader refuses them.
void encode_control(const ControlMessage& message, std::vector<std::byte>& out);

// Cuts a byte stream into messages. One instance a connection.
class ControlReader {
 public:
  enum class Status : std::uint8_t { message, need_more, broken };
  void push(std::span<const std::byte> bytes);  // ignored once broken
  // The next message; broken is final: bad length, failed verification or a value out of range.
  Status next(ControlMessage& message);

 private:
  Status refuse();

  std::vector<std::byte> buffer_;  // bytes pushed; those before read_ are done with
  std::size_t read_ = 0;
  bool broken_ = false;
};

}  // namespace wire
