#include "broadcaster.h"

#include <algorithm>

namespace server {

Broadcaster::Broadcaster(int fd, std::size_t capacity) : fd_(fd), capacity_(capacity) {
  listeners_.reserve(capacity);
  messages_.reserve(capacity);
}

void Broadcaster::add(std::uint32_t client, const sockaddr_in& listener) {
  if (listeners_.size() < capacity_) listeners_.push_back({client, listener});
}

void Broadcaster::remove(std::uint32_t client) {
  std::erase_if(listeners_, [client](const Listener& l) { return l.client == client; });
}

void Broadcaster::send(std::span<const std::byte> datagram) {
  iovec part{const_cast<std::byte*>(datagram.data()), datagram.size()};  // only read by the kernel
  messages_.clear();
  for (Listener& listener : listeners_) {
    mmsghdr message{};
    message.msg_hdr.msg_name = &listener.address;
    message.msg_hdr.msg_namelen = sizeof listener.address;
    message.msg_hdr.msg_iov = &part;
    message.msg_hdr.msg_iovlen = 1;
    messages_.push_back(message);
  }
  for (std::size_t at = 0; at < messages_.size();) {
    const auto left = static_cast<unsigned>(messages_.size() - at);
    const int sent = ::sendmmsg(fd_, messages_.data() + at, left, MSG_DONTWAIT);
    if (sent > 0) {
      at += static_cast<std::size_t>(sent);
      sent_ += static_cast<std::uint64_t>(sent);
      bytes_ += static_cast<std::uint64_t>(sent) * datagram.size();
    } else {  // the first of the rest could not be sent: the others may
      ++errors_;
      ++at;
    }
  }
}

}  // namespace server
