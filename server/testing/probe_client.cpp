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

ProbeClient::ProbeClient(std::uint16_t port, const std::string& from, const std::string& to)
    : server_(os::parse_address(to, port).value_or(os::loopback(port))) {
  const auto mine = os::parse_address(from, 0).value_or(os::loopback(0));
  udp_ = ::socket(mine.family(), SOCK_DGRAM | SOCK_CLOEXEC, 0);
  const int buffer = 4 << 20;  // so that a stalled test machine loses nothing
  ::setsockopt(udp_, SOL_SOCKET, SO_RCVBUF, &buffer, sizeof buffer);
  const bool udp_bound = ::bind(udp_, mine.generic(), mine.size()) == 0;

  tcp_ = ::socket(mine.family(), SOCK_STREAM | SOCK_CLOEXEC, 0);
  const bool tcp_bound = ::bind(tcp_, mine.generic(), mine.size()) == 0;
  if (!udp_bound || !tcp_bound || ::connect(tcp_, server_.generic(), server_.size()) != 0) leave();
}

ProbeClient::~ProbeClient() {
  leave();
  if (udp_ >= 0) ::close(udp_);
}

ProbeClient::ProbeClient(ProbeClient&& other) noexcept
    : server_(other.server_),
      tcp_(std::exchange(other.tcp_, -1)),
      udp_(std::exchange(other.udp_, -1)),
      reader_(std::move(other.reader_)),
      sealer_(other.sealer_),
      opener_(std::move(other.opener_)),
      welcome_(std::move(other.welcome_)),
      roster_(std::move(other.roster_)),
      snapshots_(other.snapshots_),
      sent_(other.sent_) {}

void ProbeClient::leave() {
  if (tcp_ >= 0) ::close(tcp_);
  tcp_ = -1;
}

void ProbeClient::send_goodbye() {
  send(wire::Bye{"done"});
  if (connected()) os::finish_sending(tcp_, kPatienceMs);
  leave();
}

std::uint16_t ProbeClient::udp_port() const {
  return os::local_address(udp_).port();
}

wire::Hello ProbeClient::hello(std::uint8_t team) const {
  wire::Hello hello;
  hello.snapshot_layout = wire::snapshot_layout_hash();
  hello.name = "probe";
  hello.udp_port = udp_port();
  hello.team = team;
  return hello;
}

bool ProbeClient::send(const wire::ControlMessage& message) {
  std::vector<std::byte> bytes;
  wire::encode_control(message, bytes);
  if (!sealer_) return send_raw(bytes);
  std::vector<std::byte> sealed;
  sealer_->seal(bytes, sealed);
  return send_raw(sealed);
}

bool ProbeClient::send_raw(std::span<const std::byte> bytes) {
  while (!bytes.empty()) {
    const ssize_t sent = ::send(tcp_, bytes.data(), bytes.size(), MSG_NOSIGNAL);
    if (sent <= 0) return false;
    bytes = bytes.subspan(static_cast<std::size_t>(sent));
  }
  return true;
}

std::optional<wire::ControlMessage> ProbeClient::receive(int patience_ms) {
  const Deadline deadline(patience_ms);
  wire::ControlMessage message;
  while (true) {
    const auto status = reader_.next(message);
    if (status == wire::ControlReader::Status::message) {
      if (const auto* roster = std::get_if<wire::Roster>(&message)) {
        roster_ = *roster;
      } else if (const auto* tuning = std::get_if<wire::Tuning>(&message)) {
        tuning_ = *tuning;
      } else if (const auto* game = std::get_if<wire::Game>(&message)) {
        game_ = *game;
      } else if (const auto* report = std::get_if<wire::Report>(&message)) {
        report_ = *report;
      } else if (const auto* characters = std::get_if<wire::Characters>(&message)) {
        characters_ = *characters;
      } else {
        return message;
      }
      continue;
    }
    if (status == wire::ControlReader::Status::broken) return std::nullopt;
    if (!wait_readable(tcp_, deadline.left_ms())) return std::nullopt;
    std::array<std::byte, 4096> buffer;
    const ssize_t size = ::recv(tcp_, buffer.data(), buffer.size(), 0);
    if (size <= 0) return std::nullopt;
    const auto bytes = std::span<const std::byte>(buffer).first(static_cast<std::size_t>(size));
    std::vector<std::byte> plain;
    if (opener_ && !opener_->open(bytes, plain)) return std::nullopt;
    reader_.push(opener_ ? std::span<const std::byte>(plain) : bytes);
  }
}

bool ProbeClient::catch_up() {
  for (int i = 0; i < 2; ++i) {
    if (!send(wire::Ping{}) || !receive_a<wire::Pong>()) return false;
  }
  return true;
}

std::optional<wire::Welcome> ProbeClient::join(std::uint8_t team, std::uint8_t rods) {
  wire::Hello wanted = hello(team);
  wanted.rods = rods;
  return join(wanted);
}

std::optional<wire::Welcome> ProbeClient::resume(const wire::Welcome& before) {
  wire::Hello wanted = hello(before.team);
  wanted.session = before.session;
  wanted.ticket = before.token;
  return join(wanted);
}

std::optional<wire::Welcome> ProbeClient::join(const wire::Hello& hello) {
  if (!connected() || !send(hello)) return std::nullopt;
  const auto answer = receive();
  const auto* welcome = answer ? std::get_if<wire::Welcome>(&*answer) : nullptr;
  if (welcome == nullptr) return std::nullopt;
  welcome_ = *welcome;
  snapshots_ = {welcome_.snapshot_key, welcome_.multicast.empty() ? welcome_.client : 0};
  sent_ = 0;
  return welcome_;
}

bool ProbeClient::prove(const std::string& password, wire::Role role) {
  wire::Knock knock;
  knock.role = number(role);
  knock.sid = wire::random_sid();
  const wire::PasswordExchange exchange(wire::PasswordExchange::Side::client, password,
                                        wire::exchange_channel(role == wire::Role::host),
                                        knock.sid);
  knock.share = exchange.share();
  if (!send(knock)) return false;
  const auto challenge = receive_a<wire::Challenge>();
  const auto secret = challenge ? exchange.secret(challenge->share) : std::nullopt;
  if (!secret) return false;
  const wire::StreamKeys keys = wire::stream_keys(*secret);
  sealer_.emplace(keys.to_server);
  opener_.emplace(keys.to_client);
  return true;
}

bool ProbeClient::sees_close(int patience_ms) {
  const Deadline deadline(patience_ms);
  std::array<std::byte, 4096> buffer;
  while (wait_readable(tcp_, deadline.left_ms())) {
    if (::recv(tcp_, buffer.data(), buffer.size(), 0) <= 0) return true;
  }
  return false;
}

std::vector<std::byte> ProbeClient::sealed(const wire::InputDatagram& input) {
  std::array<std::byte, wire::kMaxInputDatagram> bytes;
  const std::size_t size = wire::encode_input(input, bytes);
  std::vector<std::byte> out(size + wire::kSealBytes);
  wire::seal_datagram(welcome_.input_key, welcome_.client, sent_++, {bytes.data(), size}, out);
  return out;
}

bool ProbeClient::send_input(const wire::InputDatagram& input) {
  return send_datagram(sealed(input));
}

bool ProbeClient::send_datagram(std::span<const std::byte> bytes) {
  return ::sendto(udp_, bytes.data(), bytes.size(), 0, server_.generic(), server_.size()) ==
         static_cast<ssize_t>(bytes.size());
}

std::optional<wire::Snapshot> ProbeClient::snapshot(int patience_ms) {
  if (!wait_readable(udp_, patience_ms)) return std::nullopt;
  std::array<std::byte, wire::kMaxDatagram + wire::kSealBytes + 1> bytes;
  std::array<std::byte, wire::kMaxDatagram> plain;
  std::size_t plain_size = 0;
  const ssize_t size = ::recv(udp_, bytes.data(), bytes.size(), 0);
  wire::Snapshot snapshot;
  if (size < 0 ||
      snapshots_.open({bytes.data(), static_cast<std::size_t>(size)}, plain, plain_size) !=
          wire::SealVerdict::good ||
      !wire::decode_snapshot(std::span(plain).first(plain_size), snapshot)) {
    return std::nullopt;
  }
  return snapshot;
}

}  // namespace server
