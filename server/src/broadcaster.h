// One datagram to every listener, or to the multicast group: encoded once, sent with one system
// call.
#pragma once

#include <netinet/in.h>
#include <sys/socket.h>

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace server {

class Broadcaster {
 public:
  // fd: a non-blocking UDP socket, which must outlive this. capacity: listeners at most.
  Broadcaster(int fd, std::size_t capacity);

  void add(std::uint32_t client, const sockaddr_in& listener);
  void remove(std::uint32_t client);

  // Never waits: what the socket's buffer does not take is an error, counted.
  void send(std::span<const std::byte> datagram);

  std::size_t listeners() const { return listeners_.size(); }
  std::uint64_t sent() const { return sent_; }  // datagrams, over all listeners
  std::uint64_t errors() const { return errors_; }
  std::uint64_t bytes() const { return bytes_; }

 private:
  struct Listener {
    std::uint32_t client;
    sockaddr_in address;
  };
  int fd_;
  std::size_t capacity_;
  std::vector<Listener> listeners_;
  std::vector<mmsghdr> messages_;
  std::uint64_t sent_ = 0, errors_ = 0, bytes_ = 0;
};

}  // namespace server
