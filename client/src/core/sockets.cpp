#include "core/sockets.h"

#include <netdb.h>
#include <netinet/tcp.h>
#include <sys/eventfd.h>
#include <sys/socket.h>

#include <array>
#include <cerrno>
#include <cstring>

namespace client {
namespace {

std::string reason() {
  return std::strerror(errno);
}

// SO_RCVBUFFORCE may exceed net.core.rmem_max if the process has the privilege. The kernel doubles
// the granted size.
bool enlarge_receive_buffer(int fd) {
  const int wanted = kReceiveBufferBytes;
  if (setsockopt(fd, SOL_SOCKET, SO_RCVBUFFORCE, &wanted, sizeof wanted) != 0) {
    setsockopt(fd, SOL_SOCKET, SO_RCVBUF, &wanted, sizeof wanted);
  }
  int granted = 0;
  socklen_t size = sizeof granted;
  getsockopt(fd, SOL_SOCKET, SO_RCVBUF, &granted, &size);
  return granted / 2 >= wanted;
}

}  // namespace

Waker::Waker() : event_(::eventfd(0, EFD_NONBLOCK | EFD_CLOEXEC)) {}

void Waker::wake() const {
  ::eventfd_write(event_.get(), 1);  // full: the thread is already awake
}

void Waker::drain() const {
  eventfd_t count = 0;
  ::eventfd_read(event_.get(), &count);
}

tl::expected<os::SocketAddress, std::string> resolve(const std::string& host, std::uint16_t port) {
  if (const auto address = os::parse_address(host, port)) return *address;
  addrinfo hints{}, *found = nullptr;
  hints.ai_family = AF_UNSPEC;
  hints.ai_socktype = SOCK_STREAM;
  hints.ai_flags = AI_ADDRCONFIG;
  int failed = getaddrinfo(host.c_str(), nullptr, &hints, &found);
  if (failed != 0) {  // a machine with only its loopback has no configured address
    hints.ai_flags = 0;
    failed = getaddrinfo(host.c_str(), nullptr, &hints, &found);
  }
  if (failed != 0 || found == nullptr) {
    return tl::unexpected("The server's host \"" + host + "\" is not known (" +
                          gai_strerror(failed) +
                          "): give --server HOST:PORT with a name or an address that this machine "
                          "can look up.");
  }
  // IPv4 first: a server listens there by default.
  os::SocketAddress address;
  for (const addrinfo* entry = found; entry != nullptr; entry = entry->ai_next) {
    const auto candidate = os::SocketAddress::from(entry->ai_addr, entry->ai_addrlen);
    if (address.empty() || (address.is_ipv6() && candidate.family() == AF_INET))
      address = candidate;
  }
  freeaddrinfo(found);
  address.set_port(port);
  return address;
}

os::SocketAddress own_address_for(const os::SocketAddress& server) {
  const bool here = server.is_loopback();
  if (server.is_ipv6()) return *os::parse_address(here ? "::1" : "::", 0);
  return *os::parse_address(here ? "127.0.0.1" : "0.0.0.0", 0);
}

tl::expected<UdpSocket, std::string> open_udp(const os::SocketAddress& address) {
  UdpSocket udp;
  udp.fd =
      os::FileDescriptor(::socket(address.family(), SOCK_DGRAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0));
  if (!udp.fd || ::bind(udp.fd.get(), address.generic(), address.size()) != 0) {
    return tl::unexpected(
        "Cannot open a UDP socket to hear the server (" + reason() +
        "): check the limits of open files and the network's permissions of this process.");
  }
  udp.small_buffer = !enlarge_receive_buffer(udp.fd.get());
  udp.port = os::local_address(udp.fd.get()).port();
  return udp;
}

bool accept_only_from(const UdpSocket& udp, const os::SocketAddress& from) {
  return ::connect(udp.fd.get(), from.generic(), from.size()) == 0;
}

namespace {

bool join_group(int fd, const os::SocketAddress& group, const os::SocketAddress& here) {
  if (group.is_ipv6()) {
    ipv6_mreq membership{};
    membership.ipv6mr_multiaddr = group.ipv6().sin6_addr;
    membership.ipv6mr_interface = here.is_ipv6() ? here.ipv6().sin6_scope_id : 0;
    return setsockopt(fd, IPPROTO_IPV6, IPV6_ADD_MEMBERSHIP, &membership, sizeof membership) == 0;
  }
  ip_mreq membership{};
  membership.imr_multiaddr = group.ipv4().sin_addr;
  if (!here.is_ipv6()) membership.imr_interface = here.ipv4().sin_addr;
  return setsockopt(fd, IPPROTO_IP, IP_ADD_MEMBERSHIP, &membership, sizeof membership) == 0;
}

}  // namespace

tl::expected<UdpSocket, std::string> open_multicast(const std::string& group, std::uint16_t port,
                                                    const os::SocketAddress& here) {
  const auto local = os::parse_address(group, port);
  if (!local || !local->is_multicast()) {
    return tl::unexpected(
        "The server names \"" + group +
        "\" as its multicast group, which is none: check the server's --multicast.");
  }
  UdpSocket udp;
  udp.fd =
      os::FileDescriptor(::socket(local->family(), SOCK_DGRAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0));
  const int on = 1;
  setsockopt(udp.fd.get(), SOL_SOCKET, SO_REUSEADDR, &on, sizeof on);
  if (!udp.fd || ::bind(udp.fd.get(), local->generic(), local->size()) != 0 ||
      !join_group(udp.fd.get(), *local, here)) {
    return tl::unexpected(
        "Cannot join the server's multicast group " + group + " (" + reason() +
        "): start the server without --multicast, or allow multicast on this network.");
  }
  udp.small_buffer = !enlarge_receive_buffer(udp.fd.get());
  udp.port = port;
  return udp;
}

std::size_t take_datagrams(int socket, std::size_t max,
                           const std::function<void(std::span<const std::byte>)>& take) {
  std::array<std::byte, kLongestDatagram> bytes;
  std::size_t taken = 0;
  for (; taken < max; ++taken) {
    const auto size = ::recv(socket, bytes.data(), bytes.size(), 0);
    if (size < 0) break;
    take({bytes.data(), static_cast<std::size_t>(size)});
  }
  return taken;
}

tl::expected<os::FileDescriptor, std::string> begin_connect(const os::SocketAddress& server) {
  os::FileDescriptor tcp(::socket(server.family(), SOCK_STREAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0));
  if (!tcp ||
      (::connect(tcp.get(), server.generic(), server.size()) != 0 && errno != EINPROGRESS)) {
    return tl::unexpected(reason());
  }
  const int on = 1;
  setsockopt(tcp.get(), IPPROTO_TCP, TCP_NODELAY, &on, sizeof on);
  return tcp;
}

int connect_result(int socket) {
  int error = 0;
  socklen_t size = sizeof error;
  if (getsockopt(socket, SOL_SOCKET, SO_ERROR, &error, &size) != 0) return errno;
  return error;
}

}  // namespace client
