#include "os/socket_address.h"

#include <arpa/inet.h>
#include <linux/sockios.h>
#include <net/if.h>
#include <poll.h>
#include <sys/ioctl.h>
#include <sys/socket.h>

#include <charconv>
#include <cstring>

#include "os/clock.h"

namespace os {
namespace {

constexpr std::size_t kMappedAt = 12;  // the IPv4 address in ::ffff:a.b.c.d

// The IPv4 address in network order, of an address that is one or has one mapped into it.
std::optional<std::uint32_t> as_ipv4(const SocketAddress& address) {
  if (address.family() == AF_INET) return address.ipv4().sin_addr.s_addr;
  if (!address.is_ipv6() || !IN6_IS_ADDR_V4MAPPED(&address.ipv6().sin6_addr)) return std::nullopt;
  std::uint32_t mapped = 0;
  std::memcpy(&mapped, &address.ipv6().sin6_addr.s6_addr[kMappedAt], sizeof mapped);
  return mapped;
}

}  // namespace

SocketAddress SocketAddress::from(const sockaddr* address, socklen_t size) {
  SocketAddress out;
  if (address->sa_family == AF_INET && size >= sizeof(sockaddr_in)) {
    std::memcpy(&out.v4_, address, sizeof out.v4_);
  } else if (address->sa_family == AF_INET6 && size >= sizeof(sockaddr_in6)) {
    std::memcpy(&out.v6_, address, sizeof out.v6_);
  }
  return out;
}

bool SocketAddress::is_loopback() const {
  if (const auto v4 = as_ipv4(*this)) return (ntohl(*v4) >> 24) == IN_LOOPBACKNET;
  return is_ipv6() && IN6_IS_ADDR_LOOPBACK(&v6_.sin6_addr);
}

bool SocketAddress::is_any() const {
  if (family() == AF_INET) return v4_.sin_addr.s_addr == htonl(INADDR_ANY);
  return is_ipv6() && IN6_IS_ADDR_UNSPECIFIED(&v6_.sin6_addr);
}

bool SocketAddress::is_multicast() const {
  if (family() == AF_INET) return IN_MULTICAST(ntohl(v4_.sin_addr.s_addr));
  return is_ipv6() && IN6_IS_ADDR_MULTICAST(&v6_.sin6_addr);
}

bool SocketAddress::same_host(const SocketAddress& other) const {
  const auto mine = as_ipv4(*this), theirs = as_ipv4(other);
  if (mine || theirs) return mine == theirs;
  if (!is_ipv6() || !other.is_ipv6()) return family() == other.family();
  return IN6_ARE_ADDR_EQUAL(&v6_.sin6_addr, &other.v6_.sin6_addr);
}

std::string SocketAddress::machine() const {
  if (const auto v4 = as_ipv4(*this)) {
    return {reinterpret_cast<const char*>(&*v4), sizeof *v4};
  }
  std::string key(reinterpret_cast<const char*>(v6_.sin6_addr.s6_addr), sizeof v6_.sin6_addr);
  if (IN6_IS_ADDR_LINKLOCAL(&v6_.sin6_addr)) key += std::to_string(v6_.sin6_scope_id);
  return key;
}

std::string SocketAddress::network() const {
  if (as_ipv4(*this) || IN6_IS_ADDR_LINKLOCAL(&v6_.sin6_addr)) return machine();
  constexpr std::size_t kPrefixBytes = 8;
  return machine().substr(0, kPrefixBytes);
}

std::string SocketAddress::owner(const SocketAddress& local) const {
  return network() == local.network() ? machine() : network();
}

std::string SocketAddress::host() const {
  char text[INET6_ADDRSTRLEN] = "?";
  if (const auto v4 = as_ipv4(*this)) {
    ::inet_ntop(AF_INET, &*v4, text, sizeof text);
  } else if (is_ipv6()) {
    ::inet_ntop(AF_INET6, &v6_.sin6_addr, text, sizeof text);
  }
  return text;
}

std::optional<SocketAddress> parse_address(const std::string& text, std::uint16_t port) {
  sockaddr_in v4{};
  if (::inet_pton(AF_INET, text.c_str(), &v4.sin_addr) == 1) {
    v4.sin_family = AF_INET;
    v4.sin_port = htons(port);
    return SocketAddress(v4);
  }
  sockaddr_in6 v6{};
  const auto percent = text.find('%');
  if (::inet_pton(AF_INET6, text.substr(0, percent).c_str(), &v6.sin6_addr) != 1) {
    return std::nullopt;
  }
  if (percent != std::string::npos) {
    v6.sin6_scope_id = ::if_nametoindex(text.c_str() + percent + 1);
    if (v6.sin6_scope_id == 0) return std::nullopt;
  }
  v6.sin6_family = AF_INET6;
  v6.sin6_port = htons(port);
  return SocketAddress(v6);
}

SocketAddress loopback(std::uint16_t port) {
  return *parse_address("127.0.0.1", port);
}

std::string to_text(const SocketAddress& address) {
  const std::string host = address.host();
  const bool colons = host.find(':') != std::string::npos;
  return (colons ? "[" + host + "]" : host) + ":" + std::to_string(address.port());
}

bool unacknowledged(int tcp) {
  int bytes = 0;
  return ::ioctl(tcp, SIOCOUTQ, &bytes) == 0 && bytes > 0;
}

void finish_sending(int tcp, int patience_ms) {
  const std::int64_t until_us = monotonic_us() + std::int64_t{1000} * patience_ms;
  ::shutdown(tcp, SHUT_WR);  // the end is acknowledged at once
  while (unacknowledged(tcp) && monotonic_us() < until_us) ::poll(nullptr, 0, 1);
}

SocketAddress local_address(int socket) {
  sockaddr_storage storage{};
  socklen_t size = sizeof storage;
  auto* generic = reinterpret_cast<sockaddr*>(&storage);
  if (::getsockname(socket, generic, &size) != 0) return {};
  return SocketAddress::from(generic, size);
}

std::optional<HostPort> parse_host_port(const std::string& text) {
  HostPort out;
  std::string port;
  bool has_port = false;
  if (!text.empty() && text.front() == '[') {
    const auto close = text.find(']');
    if (close == std::string::npos) return std::nullopt;
    out.host = text.substr(1, close - 1);
    if (!parse_address(out.host, 0)) return std::nullopt;
    const std::string rest = text.substr(close + 1);
    has_port = !rest.empty();
    if (has_port && rest.front() != ':') return std::nullopt;
    if (has_port) port = rest.substr(1);
  } else if (parse_address(text, 0)) {
    out.host = text;
  } else {
    const auto colon = text.find(':');
    out.host = text.substr(0, colon);
    has_port = colon != std::string::npos;
    if (has_port) port = text.substr(colon + 1);
  }
  if (!has_port) return text.empty() ? std::nullopt : std::optional(out);
  int number = 0;
  const char* end = port.data() + port.size();
  const auto [stopped_at, error] = std::from_chars(port.data(), end, number);
  if (error != std::errc() || stopped_at != end || number < 1 || number > 65535) {
    return std::nullopt;
  }
  out.port = static_cast<std::uint16_t>(number);
  return out;
}

}  // namespace os
