// Sockets as the server needs them: opened with all options set, or a reason.
#pragma once

#include <netinet/in.h>

#include <optional>
#include <string>
#include <tl/expected.hpp>

#include "file_descriptor.h"
#include "server/network.h"

namespace server {

struct SocketError {
  bool occupied = false;  // the port is taken
  std::string reason;     // of the system
};

std::optional<sockaddr_in> parse_address(const std::string& address, std::uint16_t port);
std::string to_text(const sockaddr_in& address);  // "127.0.0.1:4242"
bool is_loopback(const sockaddr_in& address);

// One TCP listener and one UDP socket, both non-blocking, bound to the same port number.
struct PortPair {
  FileDescriptor tcp, udp;
  std::uint16_t port = 0;
};
tl::expected<PortPair, SocketError> open_ports(const NetworkOptions& options);

}  // namespace server
