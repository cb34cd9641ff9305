// The connection to the physics server: control messages over TCP, snapshots and inputs over UDP,
// each on its own thread. If the server falls silent, the client waits. If it stays silent or ends,
// the client retries until the server is back, and takes its seat there again. The client retries
// at the address that it resolved at the start; a server that moves to another address needs a new
// start of the client.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <tl/expected.hpp>
#include <vector>

#include "client/snapshot_buffer.h"
#include "foosball/character.h"
#include "wire/control.h"
#include "wire/input_datagram.h"

namespace client {

inline constexpr std::uint16_t kDefaultPort = 7531;

struct ConnectionOptions {
  std::string host = "127.0.0.1";
  std::uint16_t port = kDefaultPort;
  std::string name = "player";
  std::uint8_t team = wire::kWatchOnly;
  std::uint8_t rods = 0;           // rods of the team, bit 0 at -x; 0: all free rods
  std::string password;            // required of clients on other machines
  bool as_host = false;            // the host's client: asks for the host role from another machine
  bool trust_this_machine = true;  // false: also prove the password to a server on this machine
  std::int64_t silence_us = 500'000;     // no snapshot for this time: the server counts as lost
  std::int64_t gone_us = 5'000'000;      // no snapshot for this time: join again
  std::int64_t retry_us = 250'000;       // between two attempts to join
  std::int64_t patience_us = 1'000'000;  // time limit for a connection and its Welcome
};

enum class Link : std::uint8_t {
  connecting,  // has not joined yet
  joined,
  lost,     // was joined; the server is silent, or gone and being retried
  refused,  // the server's reason is in `detail`; the client retries from time to time
};

struct ConnectionStatus {
  Link link = Link::connecting;
  std::string detail;     // one sentence, or empty
  wire::Welcome welcome;  // from the last time the client joined
  // The match's characters, as the server sent them. Never null: the built-in characters until
  // then. A change of the characters changes the pointer.
  std::shared_ptr<const foosball::Characters> characters;
  std::uint64_t joins = 0;
  bool server_ended = false;          // the server said Bye when the connection was last lost
  bool small_receive_buffer = false;  // the system granted less than requested
};

class Connection {
 public:
  // Resolves the server's address and opens the UDP socket. Resolving a name may take as long as
  // the system's resolver waits (an IPv4 address needs no resolver), so call this before a window
  // opens; nothing later resolves a name. The error says what to do. An absent server is not an
  // error.
  static tl::expected<std::unique_ptr<Connection>, std::string> open(
      const ConnectionOptions& options);
  // Starts to join the server. Precondition: called once, before the functions below.
  void start();
  ~Connection();  // sends Bye; returns at once, whatever the network does

  // Any thread may call these.
  ConnectionStatus status() const;
  std::string address() const;  // "HOST:PORT"
  SceneSample sample(std::int64_t now_us);
  std::vector<wire::EventSnapshot> take_events();
  std::vector<wire::Notice> notices() const;   // active notices, oldest first
  wire::Roster roster() const;                 // the clients and their rods
  std::optional<wire::Tuning> tuning() const;  // of the joined match, once known
  std::optional<wire::Game> game() const;      // of the joined match, once known
  // The last questionnaire that the server sent in the joined session. Its players may answer.
  std::optional<wire::Questionnaire> questionnaire() const;
  // The stored report of the last match and the ranking, as the server sent them; empty: none yet.
  std::optional<wire::Report> report() const;
  // Where phones join, as the joined server sent it; empty: nowhere, or not shown to this client.
  std::string phones() const;
  // The state of the devices at the server's machine, in answer to ask_devices(). Each answer is
  // returned once.
  std::optional<wire::Devices> take_devices();
  SnapshotCounters counters() const;
  std::int64_t delay_us() const;
  // The functions below name the session whose scene the caller acted upon. A call for another
  // session than the joined one is dropped, so that nothing from an old match reaches a new one.
  //
  // Sends a request.
  void request(std::uint64_t session, const wire::MatchRequest& request);
  // Requests these rods, by bit, of this team, in place of the client's present ones; no rods: to
  // watch. roster() shows when the server has granted them.
  void claim(std::uint64_t session, const wire::Claim& claim);
  // Requests to remove this player from the match: the host decides, otherwise a vote.
  void kick(std::uint64_t session, const wire::Kick& kick);
  // Requests this game; only the host may.
  void choose(std::uint64_t session, const wire::Game& game);
  // Sets the name for the next time that the client joins.
  void join_as(const std::string& name);
  // Sends the names of the people at this client. The client also joins under that name from the
  // next time on.
  void name(std::uint64_t session, const wire::Names& names);
  // Sends a player's answers, with the match of questionnaire().
  void answer(std::uint64_t session, const wire::Answers& answers);
  // Requests the state of the devices at the server's machine. For a host; the server ignores the
  // request of other clients.
  void ask_devices(std::uint64_t session);
  // Sets the targets of this client's rods. They are sent when they change, at most once a
  // millisecond, and repeated 20 times a second until the caller has not called for a second, or
  // until the client joins the server again.
  void drive(std::uint64_t session, const std::array<wire::InputRod, 8>& rods);
  std::uint64_t inputs_sent() const;

 private:
  struct Impl;
  explicit Connection(std::unique_ptr<Impl> impl);
  std::unique_ptr<Impl> impl_;
};

}  // namespace client
