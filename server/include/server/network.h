// Network options: the addresses where the server listens and sends (IPv4 or IPv6), and who may
// join.
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
  std::string listen = "127.0.0.1";  // this machine only; "::": all, IPv4 and IPv6
  std::uint16_t port = 0;  // TCP, and UDP for input, with the same number; 0: any free one
  std::optional<Endpoint> multicast;  // snapshots go to this group instead of each listener
  int send_buffer_bytes = 1 << 20;    // a thousand datagrams: larger than any burst of the server
  int receive_buffer_bytes = 1 << 20;
};

// A client from another machine proves that it knows a password, without sending it. All further
// traffic of that client is sealed (wire/password_exchange.h). A client on this machine needs no
// password and is the host.
struct AccessOptions {
  std::optional<std::string> password;       // to play and to watch; none: no remote clients
  std::optional<std::string> host_password;  // to be a remote host; none: no remote host
  bool trust_this_machine = true;            // false: a password is required here too
  bool mixed_teams = false;                  // a remote client may have rods of both teams
};

// The port for phones (docs/phones.md).
struct PhoneLimits {
  int phones = 16;    // phones that have sent a hello; a table has rods for four
  int greeting = 64;  // phones that have not, in all; above this, the oldest phone of the
                      // network with the most of them is dropped
  std::int64_t hello_us = 5'000'000;    // from the connection to the hello or to the page's end,
                                        // even if the bytes arrive slowly
  std::int64_t silent_us = 10'000'000;  // until a phone that answers no ping counts as lost
  int messages_at_once = 200;           // of one phone; then one every 2 ms
  std::int64_t message_every_us = 2'000;
  std::size_t bytes_per_second = 32 * 1024;  // read from one connection, of any kind
  std::size_t unsent = 64;                   // messages to a phone that does not read
};
struct PhoneOptions {
  bool open = false;
  std::string listen;      // empty: the address of the control port
  std::uint16_t port = 0;  // TCP; 0: any free one
  PhoneLimits limits;
};

// Limits against hostile clients on the control port; see docs/decisions/0010 and control_server.h.
struct ControlLimits {
  int connections = 32;  // clients that are in: joined, or disconnected with a reserved seat
  int greeting = 64;     // clients that have not joined yet, in all; above this, the oldest of
                         // the network with the most of them is dropped
  int per_address = 8;   // clients that are in, of one remote machine
  int per_network = 16;  // clients that are in, of one remote IPv6 network (/64)
  int per_local_address = 32;         // of this machine, whose clients all share one address
  std::int64_t hello_us = 5'000'000;  // from the connection to the Hello, even if it arrives slowly
  std::int64_t seat_kept_us = 30'000'000;  // how long a lost player's seat is reserved
  std::size_t unsent_bytes = 256 * 1024;   // to a client that does not read; then it is dropped
};

}  // namespace server
