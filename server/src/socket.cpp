#include "socket.h"

#include <sys/socket.h>

#include <cerrno>
#include <cstring>

#include "os/socket_address.h"

namespace server {
namespace {

SocketError last_error() {
  return {errno};
}

template <class T>
bool set_option(int fd, int level, int name, const T& value) {
  return ::setsockopt(fd, level, name, &value, sizeof value) == 0;
}

tl::expected<os::FileDescriptor, SocketError> bound_socket(int type, const sockaddr_in& address) {
  os::FileDescriptor fd(::socket(AF_INET, type | SOCK_NONBLOCK | SOCK_CLOEXEC, 0));
  if (!fd) return tl::unexpected(last_error());
  // TCP: a restart does not wait for the last run's closed connections. On UDP it would let two
  // servers share a port.
  if (type == SOCK_STREAM && !set_option(fd.get(), SOL_SOCKET, SO_REUSEADDR, 1)) {
    return tl::unexpected(last_error());
  }
  if (::bind(fd.get(), os::generic(address), sizeof address) != 0) {
    return tl::unexpected(last_error());
  }
  return fd;
}

bool prepare_udp(int fd, const NetworkOptions& options, const sockaddr_in& address) {
  bool ok = set_option(fd, SOL_SOCKET, SO_SNDBUF, options.send_buffer_bytes) &&
            set_option(fd, SOL_SOCKET, SO_RCVBUF, options.receive_buffer_bytes);
  if (options.multicast) {
    // One hop: a group is for this table's network, not for the next one.
    ok = ok && set_option(fd, IPPROTO_IP, IP_MULTICAST_IF, address.sin_addr) &&
         set_option(fd, IPPROTO_IP, IP_MULTICAST_TTL, 1) &&
         set_option(fd, IPPROTO_IP, IP_MULTICAST_LOOP, 1);
  }
  return ok;
}

tl::expected<PortPair, SocketError> open_once(const NetworkOptions& options, sockaddr_in address) {
  auto tcp = bound_socket(SOCK_STREAM, address);
  if (!tcp) return tl::unexpected(tcp.error());
  if (::listen(tcp->get(), 16) != 0) return tl::unexpected(last_error());
  const std::uint16_t port = os::port_of(os::local_address(tcp->get()));
  address.sin_port = htons(port);
  auto udp = bound_socket(SOCK_DGRAM, address);
  if (!udp) return tl::unexpected(udp.error());
  if (!prepare_udp(udp->get(), options, address)) return tl::unexpected(last_error());
  return PortPair{std::move(*tcp), std::move(*udp), port};
}

}  // namespace

std::string sentence(const NetworkOptions& options, const SocketError& error) {
  const std::string where = std::to_string(options.port) + " on " + options.listen;
  switch (error.number) {
    case 0:
      return "\"" + options.listen + "\" is no IPv4 address: give one with --listen";
    case EADDRINUSE:
      return "port " + where +
             " is already in use: stop the program that has it (ss -lntup lists them), or choose "
             "another port with --port (0 takes any free one)";
    case EACCES:
      return "port " + where +
             " may not be used without rights that this program lacks, as those below 1024: choose "
             "another port with --port (0 takes any free one)";
    case EADDRNOTAVAIL:
      return "cannot listen at port " + where +
             ": no such address here; choose an address of this machine with --listen";
    default:
      return "cannot listen at port " + where + ": " + std::strerror(error.number) +
             "; close other programs, or choose another --port or --listen";
  }
}

tl::expected<PortPair, SocketError> open_ports(const NetworkOptions& options) {
  const auto address = os::parse_ipv4(options.listen, options.port);
  if (!address) return tl::unexpected(SocketError{});
  auto ports = open_once(options, *address);
  // A free TCP port whose UDP twin is taken: another free one will do.
  constexpr int kMaxTries = 16;
  for (int i = 1; i < kMaxTries && options.port == 0 && !ports && ports.error().occupied(); ++i) {
    ports = open_once(options, *address);
  }
  return ports;
}

}  // namespace server
