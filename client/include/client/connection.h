// The way to the physics server: control messages over TCP, snapshots and inputs over UDP, each on
// a thread of its own. A server that falls silent is waited for; one that stays silent, or goes
// away, is looked for again until it is back, and the seat that was held there is taken again. It
// is looked for at the address it had at the start: a server that moves to another wants a new
// start here.
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
  std::uint8_t rods = 0;           // which of the team, bit 0 at -x; 0: all that nobody has
  std::string password;            // wanted of who joins from another machine
  bool as_host = false;            // it is the host's: asks to be host from another machine
  bool trust_this_machine = true;  // false: the password is proven to a server at this machine too
  std::int64_t silence_us = 500'000;     // no snapshot for so long: the server counts as lost
  std::int64_t gone_us = 5'000'000;      // ... and for so long: it is joined anew
  std::int64_t retry_us = 250'000;       // between attempts to join
  std::int64_t patience_us = 1'000'000;  // for a connection and its Welcome
};

enum class Link : std::uint8_t {
  connecting,  // never joined yet
  joined,
  lost,     // was joined; silent, or gone and looked for
  refused,  // the server says why, in detail; asked again now and then
};

struct ConnectionStatus {
  Link link = Link::connecting;
  std::string detail;     // one sentence, or empty
  wire::Welcome welcome;  // of the last time it was joined
  // That the match has, as its server said; never null: the built-in ones until then. Another
  // pointer whenever they changed.
  std::shared_ptr<const foosball::Characters> characters;
  std::uint64_t joins = 0;
  bool server_ended = false;          // it said good-bye when it was last lost
  bool small_receive_buffer = false;  // the system granted less than was asked for
};

class Connection {
 public:
  // Looks up the server's address and opens the UDP socket. A name (an IPv4 address needs none) may
  // take as long as the system's resolver has patience, so this comes before there is a window to
  // be closed; nothing later looks a name up. The error says what to do; a server that is not there
  // is none.
  static tl::expected<std::unique_ptr<Connection>, std::string> open(
      const ConnectionOptions& options);
  // Looks for the server from now on. Precondition: called once, before the others are.
  void start();
  ~Connection();  // says Bye; at once, whatever the network does

  // Any thread.
  ConnectionStatus status() const;
  std::string address() const;  // "HOST:PORT"
  SceneSample sample(std::int64_t now_us);
  std::vector<wire::EventSnapshot> take_events();
  std::vector<wire::Notice> notices() const;   // standing ones, oldest first
  wire::Roster roster() const;                 // who is there, and which rods they have
  std::optional<wire::Tuning> tuning() const;  // of the match that is joined, once it is known
  std::optional<wire::Game> game() const;      // the same: what is played
  // What the server asked last, of the session that is joined: who played may answer.
  std::optional<wire::Questionnaire> questionnaire() const;
  // What is kept of the last match, and who plays best, as its server said; empty: nothing yet.
  std::optional<wire::Report> report() const;
  // Where phones join, as the server that is joined said; empty: nowhere, or not for this client.
  std::string phones() const;
  // What the devices of the server's machine did when it answered ask_devices(); each answer once.
  std::optional<wire::Devices> take_devices();
  SnapshotCounters counters() const;
  std::int64_t delay_us() const;
  // Both name the session whose scene the caller acted upon, and are forgotten unless it is the one
  // that is joined: nothing made of an old match reaches a new one.
  // Asks for something.
  void request(std::uint64_t session, const wire::MatchRequest& request);
  // Wants these rods, by bit, of this team, in place of the ones it has; none: to watch. roster()
  // shows when it has them.
  void claim(std::uint64_t session, const wire::Claim& claim);
  // This player is to be put out of the match: the host's word, else a vote.
  void kick(std::uint64_t session, const wire::Kick& kick);
  // This is to be played: the host's word.
  void choose(std::uint64_t session, const wire::Game& game);
  // The name to join under from the next time on.
  void join_as(const std::string& name);
  // Who the people at this client are; it joins under that name from the next time on, too.
  void name(std::uint64_t session, const wire::Names& names);
  // What a player answered, with the match of questionnaire().
  void answer(std::uint64_t session, const wire::Answers& answers);
  // What the devices of the server's machine do: for a host, the server drops it from others.
  void ask_devices(std::uint64_t session);
  // Where this person's rods shall be: sent when changed, at most every millisecond, and repeated
  // 20 times a second until nothing was heard from the caller for a second, or until the server is
  // joined anew.
  void drive(std::uint64_t session, const std::array<wire::InputRod, 8>& rods);
  std::uint64_t inputs_sent() const;

 private:
  struct Impl;
  explicit Connection(std::unique_ptr<Impl> impl);
  std::unique_ptr<Impl> impl_;
};

}  // namespace client
