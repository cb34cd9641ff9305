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

tl::expected<os::FileDescriptor, SocketError> bound_socket(int type,
                                                           const os::SocketAddress& address) {
  os::FileDescriptor fd(::socket(address.family(), type | SOCK_NONBLOCK | SOCK_CLOEXEC, 0));
  if (!fd) return tl::unexpected(last_error());
  // TCP: a restart does not wait for closed connections of the last run. For UDP, the option would
  // let two servers share a port.
  if (type == SOCK_STREAM && !set_option(fd.get(), SOL_SOCKET, SO_REUSEADDR, 1)) {
    return tl::unexpected(last_error());
  }
  // "::" receives both families, regardless of the system's default.
  if (address.is_ipv6() && !set_option(fd.get(), IPPROTO_IPV6, IPV6_V6ONLY, 0)) {
    return tl::unexpected(last_error());
  }
  if (::bind(fd.get(), address.generic(), address.size()) != 0) {
    return tl::unexpected(last_error());
  }
  return fd;
}

// One hop: the group is for the table's network only.
bool prepare_multicast(int fd, const os::SocketAddress& address) {
  if (address.is_ipv6()) {
    return set_option(fd, IPPROTO_IPV6, IPV6_MULTICAST_HOPS, 1) &&
           set_option(fd, IPPROTO_IPV6, IPV6_MULTICAST_LOOP, 1);
  }
  return set_option(fd, IPPROTO_IP, IP_MULTICAST_IF, address.ipv4().sin_addr) &&
         set_option(fd, IPPROTO_IP, IP_MULTICAST_TTL, 1) &&
         set_option(fd, IPPROTO_IP, IP_MULTICAST_LOOP, 1);
}

bool prepare_udp(int fd, const NetworkOptions& options, const os::SocketAddress& address) {
  return set_option(fd, SOL_SOCKET, SO_SNDBUF, options.send_buffer_bytes) &&
         set_option(fd, SOL_SOCKET, SO_RCVBUF, options.receive_buffer_bytes) &&
         (!options.multicast || prepare_multicast(fd, address));
}

constexpr int kBacklog = 128;  // so that a flood of connections does not fill the queue at once

tl::expected<PortPair, SocketError> open_once(const NetworkOptions& options,
                                              os::SocketAddress address) {
  // UDP first: a UDP port belongs to one socket, so that of two servers that start simultaneously
  // one gets both ports. TCP's SO_REUSEADDR lets both bind, and then listen(2) may fail for both.
  auto udp = bound_socket(SOCK_DGRAM, address);
  if (!udp) return tl::unexpected(udp.error());
  if (!prepare_udp(udp->get(), options, address)) return tl::unexpected(last_error());
  const std::uint16_t port = os::local_address(udp->get()).port();
  address.set_port(port);
  auto tcp = bound_socket(SOCK_STREAM, address);
  if (!tcp) return tl::unexpected(tcp.error());
  if (::listen(tcp->get(), kBacklog) != 0) return tl::unexpected(last_error());
  return PortPair{std::move(*tcp), std::move(*udp), port};
}

// Allows another UDP socket to bind to the socket's port during its lifetime.
class Shareable {
 public:
  explicit Shareable(int fd) : fd_(fd) { set_option(fd_, SOL_SOCKET, SO_REUSEADDR, 1); }
  ~Shareable() { set_option(fd_, SOL_SOCKET, SO_REUSEADDR, 0); }
  Shareable(const Shareable&) = delete;
  Shareable& operator=(const Shareable&) = delete;

 private:
  int fd_;
};

}  // namespace

std::string sentence(const NetworkOptions& options, const SocketError& error) {
  const std::string where = std::to_string(options.port) + " on " + options.listen;
  switch (error.number) {
    case 0:
      return "\"" + options.listen +
             "\" is not an address, such as 0.0.0.0 or ::1: give one with --listen";
    case EADDRINUSE:
      return "port " + where +
             " is already in use: stop the program that has it (ss -lntup lists them), or choose "
             "another port with --port (0 takes any free one)";
    case EACCES:
      return "port " + where +
             " needs permissions that this program lacks, as all ports below 1024: choose another "
             "port with --port (0 takes any free one)";
    case EADDRNOTAVAIL:
      return "cannot listen at port " + where +
             ": no such address here; choose an address of this machine with --listen";
    default:
      return "cannot listen at port " + where + ": " + std::strerror(error.number) +
             "; close other programs, or choose another --port or --listen";
  }
}

tl::expected<PortPair, SocketError> open_ports(const NetworkOptions& options) {
  const auto address = os::parse_address(options.listen, options.port);
  if (!address) return tl::unexpected(SocketError{});
  auto ports = open_once(options, *address);
  // The TCP port with the number of this free UDP port is in use: try another free one.
  constexpr int kMaxTries = 16;
  for (int i = 1; i < kMaxTries && options.port == 0 && !ports && ports.error().occupied(); ++i) {
    ports = open_once(options, *address);
  }
  return ports;
}

tl::expected<os::FileDescriptor, SocketError> open_client_socket(int shared,
                                                                 const os::SocketAddress& local,
                                                                 const os::SocketAddress& client) {
  constexpr int kReceiveBytes = 64 * 1024;  // a quarter of a second of inputs
  os::FileDescriptor fd(::socket(local.family(), SOCK_DGRAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0));
  if (!fd) return tl::unexpected(last_error());
  const Shareable for_a_moment(shared);
  const bool ok = set_option(fd.get(), SOL_SOCKET, SO_REUSEADDR, 1) &&
                  set_option(fd.get(), SOL_SOCKET, SO_RCVBUF, kReceiveBytes) &&
                  (!local.is_ipv6() || set_option(fd.get(), IPPROTO_IPV6, IPV6_V6ONLY, 0)) &&
                  ::bind(fd.get(), local.generic(), local.size()) == 0 &&
                  ::connect(fd.get(), client.generic(), client.size()) == 0;
  if (!ok) return tl::unexpected(last_error());
  return fd;
}

tl::expected<void, std::string> can_reach(const Endpoint& group, const NetworkOptions& options) {
  const auto to = os::parse_address(group.address, group.port);
  auto from = os::parse_address(options.listen, 0);
  if (!to || !to->is_multicast()) {
    return tl::unexpected("\"" + group.address + "\" is not a multicast group, such as 239.7.5.31");
  }
  if (!from || from->family() != to->family()) {
    return tl::unexpected("the group " + group.address + " and the address " + options.listen +
                          " are of different families: give both as IPv4 or both as IPv6");
  }
  os::FileDescriptor fd(::socket(to->family(), SOCK_DGRAM | SOCK_CLOEXEC, 0));
  const bool ok = fd && prepare_multicast(fd.get(), *from) &&
                  ::bind(fd.get(), from->generic(), from->size()) == 0 &&
                  ::connect(fd.get(), to->generic(), to->size()) == 0;
  if (ok) return {};
  return tl::unexpected("cannot send to the group " + group.address + " from " + options.listen +
                        ": " + std::strerror(errno) +
                        "; add a route (ip route add 224.0.0.0/4 dev lo), choose another --listen, "
                        "or omit --multicast");
}

}  // namespace server
