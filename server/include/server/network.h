// Where the server listens and sends, by IPv4 or IPv6, and who may join from where.
#pragma once

#include <cstdint>
#include <optional>
#include <string>

namespace server {

struct Endpoint {
  std::string address;  // "239.7.5.31", "ff15::7531"
  std::uint16_t port = 0;
};

struct NetworkOptions {
  std::string listen = "127.0.0.1";  // this machine only, unless told otherwise; "::": all, of both
                                     // families
  std::uint16_t port = 0;            // TCP, and UDP for input, on the same number; 0: any free one
  std::optional<Endpoint> multicast;  // snapshots go to this group in place of each listener
  int send_buffer_bytes = 1 << 20;    // a thousand datagrams: more than any burst of ours
  int receive_buffer_bytes = 1 << 20;
};

// Who joins from another machine proves that it knows a password, without sending it, and all that
// goes to and fro is sealed then (wire/password_exchange.h). Who joins at this machine needs none
// and is the host.
struct AccessOptions {
  std::optional<std::string> password;  // to play and to watch; none: nobody may join from afar
  std::optional<std::string> host_password;  // to be the host from afar; none: nobody may
  bool trust_this_machine = true;            // false: a password is wanted here too
  bool mixed_teams = false;                  // a client from afar may have rods of both teams
};

// The port for phones (docs/phones.md).
struct PhoneLimits {
  int phones = 16;    // that have said hello; a table has rods for four
  int greeting = 64;  // who has not yet, in all; beyond, the oldest of the network that has most of
                      // them must go
  std::int64_t hello_us = 5'000'000;    // from the connection to the hello, or to the page's end,
                                        // however either trickles
  std::int64_t silent_us = 10'000'000;  // until a phone that answers no ping is lost
  int messages_at_once = 200;           // of one phone; then one each 2 ms
  std::int64_t message_every_us = 2'000;
  std::size_t bytes_per_second = 32 * 1024;  // read from one connection, whatever they are
  std::size_t unsent = 64;                   // messages to a phone that does not read
};
struct PhoneOptions {
  bool open = false;
  std::string listen;      // empty: where the control port does
  std::uint16_t port = 0;  // TCP; 0: any free one
  PhoneLimits limits;
};

// Limits against strangers on the control port; see docs/decisions/0010 and
// control_server.h.
struct ControlLimits {
  int connections = 32;               // who is in: joined, or away and expected back
  int greeting = 64;                  // who has not joined yet, in all; beyond, the oldest of
                                      // the network that has most of them must go
  int per_address = 8;                // who is in, of one machine elsewhere
  int per_network = 16;               // who is in, of one IPv6 network (/64) elsewhere
  int per_local_address = 32;         // of this machine: all share one address
  std::int64_t hello_us = 5'000'000;  // from the connection to the Hello, however it trickles in
  std::int64_t seat_kept_us = 30'000'000;  // for a player who was lost
  std::size_t unsent_bytes = 256 * 1024;   // to a client that does not read; then it is dropped
};

}  // namespace server
