// IPv4 addresses as sockets take them.
#pragma once

#include <netinet/in.h>

#include <cstdint>
#include <optional>
#include <string>

namespace os {

// Dotted; nothing if it is no IPv4 address.
std::optional<sockaddr_in> parse_ipv4(const std::string& address, std::uint16_t port);
sockaddr_in loopback(std::uint16_t port);         // 127.0.0.1
std::string to_text(const sockaddr_in& address);  // "127.0.0.1:4242"
bool is_loopback(const sockaddr_in& address);     // 127.0.0.0/8
sockaddr_in local_address(int socket);            // what it is bound to; all zeros: nothing
inline std::uint16_t port_of(const sockaddr_in& address) {
  return ntohs(address.sin_port);
}

// As bind, connect and their kin want it.
inline sockaddr* generic(sockaddr_in& address) {
  return reinterpret_cast<sockaddr*>(&address);
}
inline const sockaddr* generic(const sockaddr_in& address) {
  return reinterpret_cast<const sockaddr*>(&address);
}

}  // namespace os
