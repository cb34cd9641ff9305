#include "socket.h"

#include <arpa/inet.h>
#include <sys/socket.h>

#include <cerrno>
#include <cstring>

namespace server {
namespace {

SocketError last_error() {
  return {errno == EADDRINUSE, std::strerror(errno)};
}

template <class T>
bool set_option(int fd, int level, int name, const T& value) {
  return ::setsockopt(fd, level, name, &value, sizeof value) == 0;
}

tl::expected<FileDescriptor, SocketError> bound_socket(int type, const sockaddr_in& address) {
  FileDescriptor fd(::socket(AF_INET, type | SOCK_NONBLOCK | SOCK_CLOEXEC, 0));
  if (!fd) return tl::unexpected(last_error());
  // TCP: a restart does not wait for the last run's closed connections. On UDP it would let two
  // servers share a port.
  if (type == SOCK_STREAM && !set_option(fd.get(), SOL_SOCKET, SO_REUSEADDR, 1)) {
    return tl::unexpected(last_error());
  }
  if (::bind(fd.get(), reinterpret_cast<const sockaddr*>(&address), sizeof address) != 0) {
    return tl::unexpected(last_error());
  }
  return fd;
}

std::uint16_t port_of(int fd) {
  sockaddr_in address{};
  socklen_t size = sizeof address;
  ::getsockname(fd, reinterpret_cast<sockaddr*>(&address), &size);
  return ntohs(address.sin_port);
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
  const std::uint16_t port = port_of(tcp->get());
  address.sin_port = htons(port);
  auto udp = bound_socket(SOCK_DGRAM, address);
  if (!udp) return tl::unexpected(udp.error());
  if (!prepare_udp(udp->get(), options, address)) return tl::unexpected(last_error());
  return PortPair{std::move(*tcp), std::move(*udp), port};
}

}  // namespace

std::optional<sockaddr_in> parse_address(const std::string& address, std::uint16_t port) {
  sockaddr_in parsed{};
  parsed.sin_family = AF_INET;
  parsed.sin_port = htons(port);
  if (::inet_pton(AF_INET, address.c_str(), &parsed.sin_addr) != 1) return std::nullopt;
  return parsed;
}

std::string to_text(const sockaddr_in& address) {
  char text[INET_ADDRSTRLEN] = {};
  ::inet_ntop(AF_INET, &address.sin_addr, text, sizeof text);
  return std::string(text) + ":" + std::to_string(ntohs(address.sin_port));
}

bool is_loopback(const sockaddr_in& address) {
  return (ntohl(address.sin_addr.s_addr) >> 24) == IN_LOOPBACKNET;
}

tl::expected<PortPair, SocketError> open_ports(const NetworkOptions& options) {
  const auto address = parse_address(options.listen, options.port);
  if (!address) {
    return tl::unexpected(SocketError{false, "\"" + options.listen + "\" is no IPv4 address"});
  }
  auto ports = open_once(options, *address);
  // A free TCP port whose UDP twin is taken: another free one will do.
  constexpr int kMaxTries = 16;
  for (int i = 1; i < kMaxTries && options.port == 0 && !ports && ports.error().occupied; ++i) {
    ports = open_once(options, *address);
  }
  return ports;
}

}  // namespace server
