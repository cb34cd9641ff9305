// Opens sockets with all options set, or returns the reason why not.
#pragma once

#include <cerrno>
#include <cstdint>
#include <string>
#include <tl/expected.hpp>

#include "os/file_descriptor.h"
#include "os/socket_address.h"
#include "server/network.h"

namespace server {

struct SocketError {
  int number = 0;  // errno, or 0: the options contain no valid address
  bool occupied() const { return number == EADDRINUSE; }
};
// Error message: what is wrong and what to do.
std::string sentence(const NetworkOptions& options, const SocketError& error);

// One TCP listener and one UDP socket, both non-blocking, bound to the same port number.
struct PortPair {
  os::FileDescriptor tcp, udp;
  std::uint16_t port = 0;
};
tl::expected<PortPair, SocketError> open_ports(const NetworkOptions& options);

// A UDP socket for one client. It is bound to the shared port and connected to the client's
// address, so that it only receives that client's datagrams. A flood from elsewhere fills the
// shared socket, not this one. shared: the port's socket. local: the server's address that the
// client reached.
tl::expected<os::FileDescriptor, SocketError> open_client_socket(int shared,
                                                                 const os::SocketAddress& local,
                                                                 const os::SocketAddress& client);

// Checks that the kernel has a route to the group from the address that the server listens at. The
// error is a sentence.
tl::expected<void, std::string> can_reach(const Endpoint& group, const NetworkOptions& options);

}  // namespace server
