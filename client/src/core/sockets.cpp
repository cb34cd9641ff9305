#include "core/sockets.h"

#include <netdb.h>
#include <netinet/tcp.h>
#include <sys/eventfd.h>
#include <sys/socket.h>

#include <array>
#include <cerrno>
#include <cstring>

#include "os/socket_address.h"

namespace client {
namespace {

std::string reason() {
  return std::strerror(errno);
}

// SO_RCVBUFFORCE goes past net.core.rmem_max where the process may; the kernel doubles what it
// grants.
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
  ::eventfd_write(event_.get(), 1);  // full: it is awake
}

void Waker::drain() const {
  eventfd_t count = 0;
  ::eventfd_read(event_.get(), &count);
}

tl::expected<sockaddr_in, std::string> resolve(const std::string& host, std::uint16_t port) {
  if (const auto dotted = os::parse_ipv4(host, port)) return *dotted;
  addrinfo hints{}, *found = nullptr;
  hints.ai_family = AF_INET;
  hints.ai_socktype = SOCK_STREAM;
  const int failed = getaddrinfo(host.c_str(), nullptr, &hints, &found);
  if (failed != 0 || found == nullptr) {
    return tl::unexpected(
        "The server's host \"" + host + "\" is not known (" + gai_strerror(failed) +
        "): give --server HOST:PORT with a name or an IPv4 address that this machine can look up.");
  }
  sockaddr_in address{};
  std::memcpy(&address, found->ai_addr, sizeof address);
  freeaddrinfo(found);
  address.sin_port = htons(port);
  return address;
}

tl::expected<UdpSocket, std::string> open_udp(std::uint32_t address, std::uint16_t port) {
  UdpSocket udp;
  udp.fd = os::FileDescriptor(::socket(AF_INET, SOCK_DGRAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0));
  sockaddr_in local{};
  local.sin_family = AF_INET;
  local.sin_addr.s_addr = address;
  local.sin_port = htons(port);
  if (!udp.fd || ::bind(udp.fd.get(), os::generic(local), sizeof local) != 0) {
    return tl::unexpected(
        "Cannot open a UDP socket to hear the server (" + reason() +
        "): check the limits of open files and the network's permissions of this process.");
  }
  udp.small_buffer = !enlarge_receive_buffer(udp.fd.get());
  udp.port = os::port_of(os::local_address(udp.fd.get()));
  return udp;
}

tl::expected<UdpSocket, std::string> open_multicast(const std::string& group, std::uint16_t port,
                                                    std::uint32_t interface) {
  UdpSocket udp;
  udp.fd = os::FileDescriptor(::socket(AF_INET, SOCK_DGRAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0));
  const int on = 1;
  setsockopt(udp.fd.get(), SOL_SOCKET, SO_REUSEADDR, &on, sizeof on);
  ip_mreq membership{};
  membership.imr_interface.s_addr = interface;
  const auto local = os::parse_ipv4(group, port);
  if (!local) {
    return tl::unexpected(
        "The server names \"" + group +
        "\" as its multicast group, which is no IPv4 address: check the server's --multicast.");
  }
  membership.imr_multiaddr = local->sin_addr;
  if (!udp.fd || ::bind(udp.fd.get(), os::generic(*local), sizeof *local) != 0 ||
      setsockopt(udp.fd.get(), IPPROTO_IP, IP_ADD_MEMBERSHIP, &membership, sizeof membership) !=
          0) {
    return tl::unexpected(
        "Cannot join the server's multicast group " + group + " (" + reason() +
        "): start the server without --multicast, or allow multicast on this network.");
  }
  udp.small_buffer = !enlarge_receive_buffer(udp.fd.get());
  udp.port = port;
  return udp;
}

std::size_t take_datagrams(int socket, std::size_t most,
                           const std::function<void(std::span<const std::byte>)>& take) {
  std::array<std::byte, kLongestDatagram> bytes;
  std::size_t taken = 0;
  for (; taken < most; ++taken) {
    const auto size = ::recv(socket, bytes.data(), bytes.size(), 0);
    if (size < 0) break;
    take({bytes.data(), static_cast<std::size_t>(size)});
  }
  return taken;
}

tl::expected<os::FileDescriptor, std::string> begin_connect(const sockaddr_in& server) {
  os::FileDescriptor tcp(::socket(AF_INET, SOCK_STREAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0));
  if (!tcp ||
      (::connect(tcp.get(), os::generic(server), sizeof server) != 0 && errno != EINPROGRESS)) {
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
