#include "probe_client.h"

#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <array>
#include <chrono>
#include <utility>

#include "os/socket_address.h"

namespace server {
namespace {

class Deadline {
 public:
  explicit Deadline(int patience_ms)
      : at_(std::chrono::steady_clock::now() + std::chrono::milliseconds(patience_ms)) {}
  int left_ms() const {
    const auto left =
        std::chrono::ceil<std::chrono::milliseconds>(at_ - std::chrono::steady_clock::now());
    return left.count() > 0 ? static_cast<int>(left.count()) : 0;
  }

 private:
  std::chrono::steady_clock::time_point at_;
};

}  // namespace

bool wait_readable(int fd, int patience_ms) {
  const Deadline deadline(patience_ms);
  pollfd polled{fd, POLLIN, 0};
  int ready = 0;
  do {
    ready = ::poll(&polled, 1, deadline.left_ms());
  } while (ready < 0);  // a signal
  return ready > 0;
}

ProbeClient::ProbeClient(std::uint16_t port, const std::string& from) : server_port_(port) {
  udp_ = ::socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0);
  const int buffer = 4 << 20;  // a stalled test machine loses nothing
  ::setsockopt(udp_, SOL_SOCKET, SO_RCVBUF, &buffer, sizeof buffer);
  const sockaddr_in mine = os::parse_ipv4(from, 0).value_or(os::loopback(0));
  const bool udp_bound = ::bind(udp_, os::generic(mine), sizeof mine) == 0;

  tcp_ = ::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0);
  const bool tcp_bound = ::bind(tcp_, os::generic(mine), sizeof mine) == 0;
  const sockaddr_in server = os::loopback(port);
  if (!udp_bound || !tcp_bound || ::connect(tcp_, os::generic(server), sizeof server) != 0) leave();
}

ProbeClient::~ProbeClient() {
  leave();
  if (udp_ >= 0) ::close(udp_);
}

ProbeClient::ProbeClient(ProbeClient&& other) noexcept
    : server_port_(other.server_port_),
      tcp_(std::exchange(other.tcp_, -1)),
      udp_(std::exchange(other.udp_, -1)),
      reader_(std::move(other.reader_)) {}

void ProbeClient::leave() {
  if (tcp_ >= 0) ::close(tcp_);
  tcp_ = -1;
}

std::uint16_t ProbeClient::udp_port() const {
  return os::port_of(os::local_address(udp_));
}

wire::Hello ProbeClient::hello(std::uint8_t team) const {
  wire::Hello hello;
  hello.snapshot_layout = wire::snapshot_layout_hash();
  hello.name = "probe";
  hello.udp_port = udp_port();
  hello.team = team;
  return hello;
}

bool ProbeClient::say(const wire::ControlMessage& message) {
  std::vector<std::byte> bytes;
  wire::encode_control(message, bytes);
  return send_raw(bytes);
}

bool ProbeClient::send_raw(std::span<const std::byte> bytes) {
  while (!bytes.empty()) {
    const ssize_t sent = ::send(tcp_, bytes.data(), bytes.size(), MSG_NOSIGNAL);
    if (sent <= 0) return false;
    bytes = bytes.subspan(static_cast<std::size_t>(sent));
  }
  return true;
}

std::optional<wire::ControlMessage> ProbeClient::hear(int patience_ms) {
  const Deadline deadline(patience_ms);
  wire::ControlMessage message;
  while (true) {
    const auto status = reader_.next(message);
    if (status == wire::ControlReader::Status::message) return message;
    if (status == wire::ControlReader::Status::broken) return std::nullopt;
    if (!wait_readable(tcp_, deadline.left_ms())) return std::nullopt;
    std::array<std::byte, 4096> buffer;
    const ssize_t size = ::recv(tcp_, buffer.data(), buffer.size(), 0);
    if (size <= 0) return std::nullopt;
    reader_.push({buffer.data(), static_cast<std::size_t>(size)});
  }
}

std::optional<wire::Welcome> ProbeClient::join(std::uint8_t team) {
  if (!connected() || !say(hello(team))) return std::nullopt;
  const auto answer = hear();
  const auto* welcome = answer ? std::get_if<wire::Welcome>(&*answer) : nullptr;
  return welcome ? std::optional(*welcome) : std::nullopt;
}

bool ProbeClient::sees_close(int patience_ms) {
  const Deadline deadline(patience_ms);
  std::array<std::byte, 4096> buffer;
  while (wait_readable(tcp_, deadline.left_ms())) {
    if (::recv(tcp_, buffer.data(), buffer.size(), 0) <= 0) return true;
  }
  return false;
}

bool ProbeClient::send_input(const wire::InputDatagram& input) {
  std::array<std::byte, wire::kMaxInputDatagram> bytes;
  const std::size_t size = wire::encode_input(input, bytes);
  return send_datagram({bytes.data(), size});
}

bool ProbeClient::send_datagram(std::span<const std::byte> bytes) {
  const sockaddr_in to = os::loopback(server_port_);
  return ::sendto(udp_, bytes.data(), bytes.size(), 0, os::generic(to), sizeof to) ==
         static_cast<ssize_t>(bytes.size());
}

std::optional<wire::Snapshot> ProbeClient::snapshot(int patience_ms) {
  if (!wait_readable(udp_, patience_ms)) return std::nullopt;
  std::array<std::byte, wire::kMaxDatagram + 1> bytes;
  const ssize_t size = ::recv(udp_, bytes.data(), bytes.size(), 0);
  wire::Snapshot snapshot;
  if (size < 0 ||
      !wire::decode_snapshot({bytes.data(), static_cast<std::size_t>(size)}, snapshot)) {
    return std::nullopt;
  }
  return snapshot;
}

}  // namespace server
