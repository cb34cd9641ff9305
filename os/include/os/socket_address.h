// IPv4 and IPv6 addresses in the form that sockets use.
#pragma once

#include <netinet/in.h>

#include <cstdint>
#include <optional>
#include <string>

namespace os {

// An address and a port, or none (family AF_UNSPEC). A socket that listens at "::" also receives
// IPv4. Such peers have IPv4 addresses mapped into IPv6; this class treats them as IPv4 addresses.
class SocketAddress {
 public:
  SocketAddress() = default;
  explicit SocketAddress(const sockaddr_in& v4) { v4_ = v4; }
  explicit SocketAddress(const sockaddr_in6& v6) { v6_ = v6; }
  // An address of getaddrinfo() or accept(); none if it is neither IPv4 nor IPv6.
  static SocketAddress from(const sockaddr* address, socklen_t size);

  int family() const { return v4_.sin_family; }
  bool empty() const { return family() == AF_UNSPEC; }
  bool is_ipv6() const { return family() == AF_INET6; }
  std::uint16_t port() const { return ntohs(is_ipv6() ? v6_.sin6_port : v4_.sin_port); }
  void set_port(std::uint16_t port) { (is_ipv6() ? v6_.sin6_port : v4_.sin_port) = htons(port); }

  bool is_loopback() const;                          // 127.0.0.0/8, ::1
  bool is_any() const;                               // 0.0.0.0, ::
  bool is_multicast() const;                         // 224.0.0.0/4, ff00::/8
  bool same_host(const SocketAddress& other) const;  // ignores the ports
  // Keys for limits; all ignore the port. Key of one machine: the full address; for a link-local
  // address, also the interface.
  std::string machine() const;
  // Key of the addresses that one owner can have: for IPv4 the address itself, for IPv6 the first
  // 64 bits. For link-local addresses (fe80::/10), which share those 64 bits on every LAN, the
  // machine.
  std::string network() const;
  // Key of an owner who may have several addresses, for instance for one vote each: the network. If
  // the network is also that of `local`, the address that received the peer (a neighbour on
  // the LAN), the machine.
  std::string owner(const SocketAddress& local) const;
  std::string host() const;  // "127.0.0.1", "::1"

  const sockaddr_in& ipv4() const { return v4_; }   // precondition: !is_ipv6()
  const sockaddr_in6& ipv6() const { return v6_; }  // precondition: is_ipv6()

  // As bind(), connect() and similar calls take it.
  sockaddr* generic() { return reinterpret_cast<sockaddr*>(&v6_); }
  const sockaddr* generic() const { return reinterpret_cast<const sockaddr*>(&v6_); }
  socklen_t size() const { return is_ipv6() ? sizeof v6_ : sizeof v4_; }
  static constexpr socklen_t kRoom = sizeof(sockaddr_in6);

 private:
  union {
    sockaddr_in6 v6_{};
    sockaddr_in v4_;  // the family is at the same offset in both
  };
};

// "127.0.0.1", "::1", "fe80::1%eth0"; nothing if the text is not an address.
std::optional<SocketAddress> parse_address(const std::string& text, std::uint16_t port);
SocketAddress loopback(std::uint16_t port);         // 127.0.0.1
std::string to_text(const SocketAddress& address);  // "127.0.0.1:4242", "[::1]:4242"
SocketAddress local_address(int socket);            // it is bound to; none if unbound

// True if the peer's kernel has not acknowledged all sent data. Closing a connection with unread
// received data resets it, and data that has not arrived by then is lost.
bool unacknowledged(int tcp);
// Ends sending (half-close), then waits until all sent data has arrived, or until the timeout.
void finish_sending(int tcp, int patience_ms);

struct HostPort {
  std::string host;  // empty: not given
  std::optional<std::uint16_t> port;
};
// "HOST", "HOST:PORT", ":PORT", "[::1]:PORT", "::1"; nothing if the text is none of these.
std::optional<HostPort> parse_host_port(const std::string& text);

}  // namespace os
