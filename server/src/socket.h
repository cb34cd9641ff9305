// Sockets as the server needs them: opened with all options set, or a reason.
#pragma once

#include <cerrno>
#include <cstdint>
#include <string>
#include <tl/expected.hpp>

#include "os/file_descriptor.h"
#include "server/network.h"

namespace server {

struct SocketError {
  int number = 0;  // errno, or 0: the options name no address
  bool occupied() const { return number == EADDRINUSE; }
};
// What is wrong and what to do.
std::string sentence(const NetworkOptions& options, const SocketError& error);

// One TCP listener and one UDP socket, both non-blocking, bound to the same port number.
struct PortPair {
  os::FileDescriptor tcp, udp;
  std::uint16_t port = 0;
};
tl::expected<PortPair, SocketError> open_ports(const NetworkOptions& options);

}  // namespace server
