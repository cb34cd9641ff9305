// The client's sockets: non-blocking, closed by their owner's destructor.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>
#include <string>
#include <tl/expected.hpp>

#include "os/file_descriptor.h"
#include "os/socket_address.h"

namespace client {

// Wakes a thread that waits in poll().
class Waker {
 public:
  Waker();
  int fd() const { return event_.get(); }
  void wake() const;
  void drain() const;

 private:
  os::FileDescriptor event_;
};

inline constexpr int kReceiveBufferBytes =
    4 * 1024 * 1024;  // a stall of half a second at 1 kHz loses nothing

struct UdpSocket {
  os::FileDescriptor fd;
  std::uint16_t port = 0;
  bool small_buffer = false;  // the system granted less than kReceiveBufferBytes
};

// The system resolves a name, which may take long; an address needs no resolver.
tl::expected<os::SocketAddress, std::string> resolve(const std::string& host, std::uint16_t port);
// The local address on which to receive from that server: for a server on this machine, the
// loopback address.
os::SocketAddress own_address_for(const os::SocketAddress& server);
// address: to receive on; port 0: any free port.
tl::expected<UdpSocket, std::string> open_udp(const os::SocketAddress& address);
// Connects the socket: from now on the kernel drops datagrams from other addresses and ports. May
// be called again.
bool accept_only_from(const UdpSocket& udp, const os::SocketAddress& from);
// A socket that receives the multicast group, on the interface with the address `here`.
tl::expected<UdpSocket, std::string> open_multicast(const std::string& group, std::uint16_t port,
                                                    const os::SocketAddress& here);
// Receives up to `most` pending datagrams, truncated to kLongestDatagram bytes, and returns their
// number. The bytes are valid until `take` returns.
inline constexpr std::size_t kLongestDatagram = 2048;
std::size_t take_datagrams(int socket, std::size_t max,
                           const std::function<void(std::span<const std::byte>)>& take);
// Starts to connect; the socket becomes writable when the connection succeeds or fails.
tl::expected<os::FileDescriptor, std::string> begin_connect(const os::SocketAddress& server);
// 0: connected; else the errno.
int connect_result(int socket);

}  // namespace client
