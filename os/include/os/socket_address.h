// IPv4 and IPv6 addresses as sockets take them.
#pragma once

#include <netinet/in.h>

#include <cstdint>
#include <optional>
#include <string>

namespace os {

// An address and a port, or none (family AF_UNSPEC). A socket that listens at "::" hears IPv4 too:
// such peers are IPv4 addresses mapped into IPv6, and count as what they are.
class SocketAddress {
 public:
  SocketAddress() = default;
  explicit SocketAddress(const sockaddr_in& v4) { v4_ = v4; }
  explicit SocketAddress(const sockaddr_in6& v6) { v6_ = v6; }
  // Of any family that getaddrinfo() or accept() gave; none if it is neither.
  static SocketAddress from(const sockaddr* address, socklen_t size);

  int family() const { return v4_.sin_family; }
  bool empty() const { return family() == AF_UNSPEC; }
  bool is_ipv6() const { return family() == AF_INET6; }
  std::uint16_t port() const { return ntohs(is_ipv6() ? v6_.sin6_port : v4_.sin_port); }
  void set_port(std::uint16_t port) { (is_ipv6() ? v6_.sin6_port : v4_.sin_port) = htons(port); }

  bool is_loopback() const;                          // 127.0.0.0/8, ::1
  bool is_any() const;                               // 0.0.0.0, ::
  bool is_multicast() const;                         // 224.0.0.0/4, ff00::/8
  bool same_host(const SocketAddress& other) const;  // whatever the ports
  // Keys for limits, whatever the port. One machine: the whole address, and of a link-local one the
  // interface too.
  std::string machine() const;
  // All that one owner can have addresses in: of IPv4 the address itself, of IPv6 the first 64
  // bits. Link-local addresses (fe80::/10) share those 64 bits on every LAN: there it is the
  // machine.
  std::string network() const;
  // Key of one who may have several addresses, whoever has one vote, for instance: the network, but
  // of who shares the 64 bits of the address that he is heard at, a neighbour on the LAN, the
  // machine.
  std::string owner(const SocketAddress& heard_at) const;
  std::string host() const;  // "127.0.0.1", "::1"

  const sockaddr_in& ipv4() const { return v4_; }   // precondition: !is_ipv6()
  const sockaddr_in6& ipv6() const { return v6_; }  // precondition: is_ipv6()

  // As bind, connect and their kin want it.
  sockaddr* generic() { return reinterpret_cast<sockaddr*>(&v6_); }
  const sockaddr* generic() const { return reinterpret_cast<const sockaddr*>(&v6_); }
  socklen_t size() const { return is_ipv6() ? sizeof v6_ : sizeof v4_; }
  static constexpr socklen_t kRoom = sizeof(sockaddr_in6);

 private:
  union {
    sockaddr_in6 v6_{};
    sockaddr_in v4_;  // the family is at the same place in both
  };
};

// "127.0.0.1", "::1", "fe80::1%eth0"; nothing if it is no address.
std::optional<SocketAddress> parse_address(const std::string& text, std::uint16_t port);
SocketAddress loopback(std::uint16_t port);         // 127.0.0.1
std::string to_text(const SocketAddress& address);  // "127.0.0.1:4242", "[::1]:4242"
SocketAddress local_address(int socket);            // what it is bound to; none: nothing

// Whether the peer's kernel has not acknowledged all that was sent. A connection that is closed
// with something unread is reset, and what has not arrived by then never does.
bool unacknowledged(int tcp);
// Nothing more is sent: waits, before the end, until all that was has arrived, or so long.
void finish_sending(int tcp, int patience_ms);

struct HostPort {
  std::string host;  // empty: not given
  std::optional<std::uint16_t> port;
};
// "HOST", "HOST:PORT", ":PORT", "[::1]:PORT", "::1"; nothing if it is none of these.
std::optional<HostPort> parse_host_port(const std::string& text);

}  // namespace os
