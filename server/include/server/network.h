// Where the server listens and sends. IPv4.
#pragma once

#include <cstdint>
#include <optional>
#include <string>

namespace server {

struct Endpoint {
  std::string address;  // dotted
  std::uint16_t port = 0;
};

struct NetworkOptions {
  std::string listen = "127.0.0.1";   // this machine only, unless told otherwise
  std::uint16_t port = 0;             // TCP, and UDP for input, on the same number; 0: any free one
  std::optional<Endpoint> multicast;  // snapshots go to this group in place of each listener
  int send_buffer_bytes = 1 << 20;    // a thousand datagrams: more than any burst of ours
  int receive_buffer_bytes = 1 << 20;
};

// Limits against strangers on the control port; see docs/decisions/0010 and
// control_server.h.
struct ControlLimits {
  int connections = 32;                   // in all
  int per_address = 8;                    // from one other machine
  int per_local_address = 32;             // from this machine: they all share one address
  std::int64_t hello_us = 5'000'000;      // to say Hello in
  std::size_t unsent_bytes = 256 * 1024;  // to a client that does not read; then it is dropped
};

}  // namespace server
