#include "control_connection.h"

#include <netinet/tcp.h>
#include <poll.h>
#include <sys/socket.h>

#include <array>
#include <cerrno>

namespace server {
namespace {

// Sent bytes are erased in blocks of this size while a peer reads without ever catching up. Smaller
// blocks would move the unsent bytes more often.
constexpr std::size_t kSentBytesKept = 16 * 1024;

bool would_block() {
  return errno == EAGAIN || errno == EWOULDBLOCK || errno == EINTR;
}

// Detects a peer that disappeared without closing (power, cable) within about 10 s.
void watch_for_silence(int fd) {
  const auto set = [fd](int level, int name, int value) {
    ::setsockopt(fd, level, name, &value, sizeof value);
  };
  set(SOL_SOCKET, SO_KEEPALIVE, 1);
  set(IPPROTO_TCP, TCP_KEEPIDLE, 4);
  set(IPPROTO_TCP, TCP_KEEPINTVL, 2);
  set(IPPROTO_TCP, TCP_KEEPCNT, 3);
  set(IPPROTO_TCP, TCP_USER_TIMEOUT, 10'000);
  set(IPPROTO_TCP, TCP_NODELAY, 1);
}

}  // namespace

ControlConnection::ControlConnection(os::FileDescriptor socket, const os::SocketAddress& peer,
                                     std::int64_t hello_deadline_us)
    : deadline_us(hello_deadline_us), socket_(std::move(socket)), peer_(peer) {
  watch_for_silence(socket_.get());
}

os::SocketAddress ControlConnection::local_address() const {
  return vouched_at_ ? *vouched_at_ : os::local_address(socket_.get());
}

void ControlConnection::vouch(const os::SocketAddress& local) {
  vouched_at_ = local;
  role = wire::Role::player;
}

bool ControlConnection::receive() {
  std::array<std::byte, 16 * 1024> buffer;
  const ssize_t size = ::recv(socket_.get(), buffer.data(), buffer.size(), MSG_DONTWAIT);
  if (size < 0) return would_block();
  if (size == 0) return false;
  received_ = true;
  if (state == State::closing) return true;
  const auto bytes = std::span<const std::byte>(buffer).first(static_cast<std::size_t>(size));
  if (!opener_) {
    reader_.push(bytes);
    return true;
  }
  std::vector<std::byte> plain;
  const bool whole = opener_->open(bytes, plain);
  wrong_password_ = !whole && !opened_;
  opened_ = opened_ || !plain.empty();
  reader_.push(plain);
  return whole;
}

void ControlConnection::seal(const wire::StreamKeys& keys) {
  reader_ = {};  // discards data received before the seal
  opener_.emplace(keys.to_server);
  sealer_.emplace(keys.to_client);
}

wire::ControlReader::Status ControlConnection::next(wire::ControlMessage& message) {
  return reader_.next(message);
}

bool ControlConnection::send(const wire::ControlMessage& message, std::size_t cap) {
  if (sealer_) {
    std::vector<std::byte> plain;
    wire::encode_control(message, plain);
    sealer_->seal(plain, out_);
  } else {
    wire::encode_control(message, out_);
  }
  return out_.size() - sent_ <= cap;
}

bool ControlConnection::flush() {
  while (wants_to_send()) {
    const ssize_t size = ::send(socket_.get(), out_.data() + sent_, out_.size() - sent_,
                                MSG_DONTWAIT | MSG_NOSIGNAL);
    if (size < 0) {
      const bool later = would_block();
      if (sent_ >= kSentBytesKept) forget_sent();
      return later;
    }
    sent_ += static_cast<std::size_t>(size);
  }
  forget_sent();
  if (shut_when_sent_) ::shutdown(socket_.get(), SHUT_WR);
  return true;
}

bool ControlConnection::peer_left() const {
  pollfd polled{socket_.get(), POLLRDHUP, 0};
  return ::poll(&polled, 1, 0) == 1;  // POLLRDHUP, POLLHUP or POLLERR
}

void ControlConnection::forget_sent() {
  out_.erase(out_.begin(), out_.begin() + static_cast<std::ptrdiff_t>(sent_));
  sent_ = 0;
}

void ControlConnection::close_softly(std::int64_t until_us) {
  state = State::closing;
  deadline_us = until_us;
  shut_when_sent_ = true;
}

}  // namespace server
