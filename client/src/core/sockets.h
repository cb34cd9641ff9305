// The sockets of the client: non-blocking, closed with their owner.
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
    4 * 1024 * 1024;  // half a second's stall at 1 kHz loses nothing

struct UdpSocket {
  os::FileDescriptor fd;
  std::uint16_t port = 0;
  bool small_buffer = false;  // less than kReceiveBufferBytes was granted
};

// A name is looked up by the system, which may take long; an address is not.
tl::expected<os::SocketAddress, std::string> resolve(const std::string& host, std::uint16_t port);
// Where to hear that server: of one at this machine, at this machine only.
os::SocketAddress own_address_for(const os::SocketAddress& server);
// address: where to listen; its port 0: any free one.
tl::expected<UdpSocket, std::string> open_udp(const os::SocketAddress& address);
// From now on the kernel lets in what comes from that address and port alone. May be called again.
bool hear_only(const UdpSocket& udp, const os::SocketAddress& from);
// A socket that hears the group, on the interface that has the address `here`.
tl::expected<UdpSocket, std::string> open_multicast(const std::string& group, std::uint16_t port,
                                                    const os::SocketAddress& here);
// Takes the datagrams that have come, at most so many, cut to kLongestDatagram bytes; how many it
// were. The bytes are the taker's until it returns.
inline constexpr std::size_t kLongestDatagram = 2048;
std::size_t take_datagrams(int socket, std::size_t most,
                           const std::function<void(std::span<const std::byte>)>& take);
// Begins to connect; finished (or failed) when the socket turns writable.
tl::expected<os::FileDescriptor, std::string> begin_connect(const os::SocketAddress& server);
// 0: connected; else the errno.
int connect_result(int socket);

}  // namespace client
