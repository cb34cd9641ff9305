// The TCP control messages, in both directions. Each is a FlatBuffers table in wire/control.fbs,
// verified before it is read. These are the plain structs that the processes use.
//
// Framing: u32 length (little endian, of the bytes that follow), then the FlatBuffers buffer. A
// length above kMaxControlMessage ends the connection before anything is allocated.
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

// The player of each rod. Empty: the person whose name the seat has, or nobody.
using RodPlayers = std::array<std::string, kRods>;

// Client to server, first message from another machine: starts the exchange of
// wire/password_exchange.h. After its Challenge, both directions are a sealed stream (wire/seal.h)
// of messages.
struct Knock {
  std::uint16_t version = kControlVersion;
  std::uint8_t role = 0;  // Role (wire/enums.h), requested; each has its password
  std::array<std::byte, 16> sid{};
  std::array<std::byte, 32> share{};
};
// Server to client: its answer.
struct Challenge {
  std::array<std::byte, 32> share{};
};

// Client to server: the first message of a client on the server's machine, otherwise the first
// sealed one. Must arrive within 5 s of connecting.
struct Hello {
  std::uint16_t version = kControlVersion;
  std::uint32_t snapshot_layout = 0;  // snapshot_layout_hash()
  std::string name;                   // at most 64 bytes of UTF-8
  std::uint16_t udp_port = 0;         // where this client listens for snapshots
  std::uint8_t team = kWatchOnly;     // 0, 1: requests rods of that team
  std::uint8_t rods = 0;              // which ones, bit 0 at -x; 0: all free rods of the team
  std::uint64_t session = 0;          // with ticket: of the last Welcome, to resume the
  std::uint64_t ticket = 0;           // same seat; 0: a new one
};

// Server to client: accepted.
struct Welcome {
  std::uint64_t session = 0;     // identifies this run of the server
  std::uint64_t token = 0;       // the client's secret: for its inputs, and the ticket of its seat
  std::uint16_t udp_port = 0;    // where the server receives input datagrams
  std::uint32_t tick_us = 1000;  // 1..kMaxTickUs (wire/limits.h)
  std::uint8_t layout = 0;       // foosball::Layout
  std::uint8_t team = kWatchOnly;  // granted
  std::string multicast;           // group address, or empty for unicast to udp_port
  std::uint16_t multicast_port = 0;
  std::uint8_t rods = 0;                     // granted, bit 0 at -x
  std::uint8_t role = 0;                     // Role, granted
  std::uint32_t client = 0;                  // the client's number, and the id of its keys
  std::array<std::byte, 32> input_key{};     // seals what the client sends
  std::array<std::byte, 32> snapshot_key{};  // seals snapshots; with multicast, shared by all, id 0
};

// Client to server: replaces the client's rods. The answer is a Roster, or a Notice with the reason
// why not.
struct Claim {
  std::uint8_t rods = 0;           // bit 0 at -x; 0: gives up its rods, and watches
  std::uint8_t team = kWatchOnly;  // plays for it from now on; kWatchOnly: for its current one
};

// Client to server: the names of the people at this client. A name that another person here has
// already, or that the results use for something else, gets a number appended. The Roster has the
// name in use.
struct Names {
  std::string name;    // of the client's seat
  RodPlayers players;  // of its rods
};

// Client to server: requests that this player is removed from the match. A host's request is
// carried out. A player's request begins a vote or agrees to one. A Notice of kKickAnswerTopic
// gives the reason if it does neither.
struct Kick {
  std::uint32_t client = 0;  // of the Roster; never 0
};

// Server to client: the tuning values of the match, on joining and after each change.
struct Tuning {
  std::array<double, kTuningCount> values{};  // finite, in the order of foosball/tuning.h
};

// The game to play. Client to server: a request, of which only the host's counts. Server to client:
// the current choice, on joining and after each change. It takes effect on the logo and selection
// screens. During play it waits for the next match or for a restart. A request has 0 for values
// that the mode does not leave open (foosball/game_setup.h). A Notice of kGameAnswerTopic gives the
// reason for a rejection.
struct Game {
  std::uint8_t mode = 0, rule_set = 0;  // Mode, RuleSet (wire/enums.h)
  std::uint8_t goals = 0;               // that win a set; 0: default of the rules
  std::uint8_t sets = 0;                // best of; 0: default of the rules
  std::uint32_t match_ms = 0;           // time of play of a set; 0: no limit
  bool change_sides = false;
  // Of the computer players. If the mode decides, the server sends those of the challenge's
  // opponent; on the ladder it sends 0, since the rung defines the opponent.
  std::uint8_t level = 0;  // from 1
  std::uint8_t style = 0;  // from 1: wall, shooter, passer, gambler; 0: default of the level
  std::uint32_t date = 0;  // server: of a challenge; client: 0, for today's
  bool waits = false;      // server: it is not the game that is being played
  bool operator==(const Game&) const = default;
};

// A client with a seat at the table.
struct Seat {
  std::uint32_t client = 0;
  std::string name;
  std::uint8_t team = kWatchOnly, rods = 0, role = 0;
  bool away = false;  // was lost: the seat is reserved for a while
};
// Server to client: all seats, after each change.
struct Roster {
  std::vector<Seat> seats;  // <= kMaxSeats
  RodPlayers players;
};

// Server to client: rejected; the connection closes.
struct Refusal {
  enum class Code : std::uint8_t {
    version,
    layout,
    full,
    bad_message,
    team_taken,
    password,     // missing or wrong
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

// Both directions; the receiver answers with the same id.
struct Ping {
  std::uint64_t id = 0;
};
struct Pong {
  std::uint64_t id = 0;
};

// Server to client: a message for a person ("cabinet /dev/ttyACM0 unplugged: its rods hold").
struct Notice {
  enum class Level : std::uint8_t { info, warning, cleared };
  Level level = Level::info;
  std::uint32_t topic = 0;  // a later notice of the same topic replaces this one
  std::string text;
};

// Both directions, before closing on purpose.
struct Bye {
  std::string reason;
};

// Server to client, when a match that is stored in the results was won: the players of these rods
// may answer the questionnaire at this client.
struct Questionnaire {
  std::uint32_t match = 0;  // counted from 1 since the server's start
  std::uint8_t rods = 0;    // bit 0 at -x; never 0
};

// Client to server: the answers of one player. A Notice of kAnswersTopic gives the reason if they
// are not stored.
struct Answers {
  std::uint32_t match = 0;  // of the Questionnaire
  std::uint8_t rods = 0;    // of this player, of one team; never 0
  // By question (docs/questionnaire.md): 1 strongly disagree .. kMaxScore strongly agree; 0: none.
  std::array<std::uint8_t, kQuestionCount> scores{};
};

// Statistics of a team in a match, as stored in the results.
struct TeamReport {
  std::uint32_t shots = 0, shots_on_target = 0, saves = 0, passes = 0, own_goals = 0;
  float possession = 0.0f;                    // since its last touch [s]; finite, as all here
  float rating = 0.0f, rating_change = 0.0f;  // mean Elo of its players after the match; change
  float fastest_shot = 0.0f;                  // [m/s]; 0: no shot, or unknown
};
struct Fame {
  std::string name;
  float rating = 0.0f;
  std::uint32_t matches = 0, wins = 0;
  float fastest_shot = 0.0f;                 // of the player's teams [m/s]; 0: unknown
  std::uint32_t shots_faced = 0, saves = 0;  // of the player's teams: shots on target, and saves
};
// Server to client, on joining and after each match that is stored: the last match and the best
// players.
struct Report {
  std::uint32_t match = 0;  // counted from 1 since the server's start; 0: none yet
  std::array<TeamReport, kTeamCount> teams{};
  std::vector<Fame> fame;  // <= kMaxFame, best first
};

// Server to client, to players and hosts, on joining: the URL where phones join as pairs of rods
// (wire/phone_message.h). Anyone who knows it may play.
struct Phones {
  std::string url;
};

// Client to server, from a host: requests the state of the controllers and mice. The server answers
// with Devices, at most every 20 ms.
struct DeviceQuery {};

// A rod as a device measures it.
struct DeviceRod {
  std::uint8_t status = 0;                         // RodStatus (wire/enums.h)
  std::int64_t slide_counts = 0, spin_counts = 0;  // of its sensor, since its first frame
  float slide = 0.0f, angle = 0.0f;                // calibrated [m], [rad]; finite
  bool operator==(const DeviceRod&) const = default;
};
// A controller or a mouse at the server's machine. Counters start with the server.
struct DeviceReport {
  std::string name;        // at most 64 bytes
  std::uint8_t state = 0;  // DeviceState (wire/enums.h)
  std::uint64_t frames = 0, lost = 0, bad = 0, stale = 0, reopened = 0;
  std::uint64_t overflows = 0, impossible = 0, line_errors = 0;  // reported by or about its sensors
  // Latency from a frame's arrival at the machine to the tick that uses it: number of measurements,
  // sum, maximum [us].
  std::uint64_t stamped = 0, latency_sum_us = 0, latency_max_us = 0;
  std::array<DeviceRod, kRods> rods;
  bool operator==(const DeviceReport&) const = default;
};
// Server to client: the answer to a DeviceQuery.
struct Devices {
  std::int64_t time_us = 0;           // the server's clock
  std::vector<DeviceReport> devices;  // <= kMaxDevices
};

using ControlMessage =
    std::variant<Hello, Welcome, Refusal, MatchRequest, Ping, Pong, Notice, Bye, Knock, Challenge,
                 Claim, Roster, Tuning, Characters, Questionnaire, Answers, Report, Kick, Game,
                 Names, Phones, DeviceQuery, Devices>;

// Appends the framed message. Truncates texts to their limits and replaces control characters and
// bytes that are not UTF-8 with '?'. Precondition: numbers are in range; the reader rejects others.
void encode_control(const ControlMessage& message, std::vector<std::byte>& out);

// Splits a byte stream into messages. One instance per connection.
class ControlReader {
 public:
  enum class Status : std::uint8_t { message, need_more, broken };
  void push(std::span<const std::byte> bytes);  // ignored once broken
  // Reads the next message. broken is final: bad length, failed verification, or a value out of
  // range.
  Status next(ControlMessage& message);

 private:
  Status refuse();

  std::vector<std::byte> buffer_;  // received bytes; those before read_ are consumed
  std::size_t read_ = 0;
  bool broken_ = false;
};

}  // namespace wire
