// A client reduced to its sockets, for tests and the loop benchmark: joins, listens, sends what it
// is told, good or bad. Every wait has a deadline and ends as soon as something arrives.
#pragma once

#include <netinet/in.h>

#include <cstdint>
#include <optional>
#include <span>
#include <string>

#include "wire/control.h"
#include "wire/input_datagram.h"
#include "wire/snapshot.h"

namespace server {

class ProbeClient {
 public:
  static constexpr int kPatienceMs = 5000;  // long enough for a busy machine; never slept through

  // from: the loopback address it connects from and listens at.
  explicit ProbeClient(std::uint16_t port, const std::string& from = "127.0.0.1");
  ~ProbeClient();
  ProbeClient(ProbeClient&& other) noexcept;
  ProbeClient(const ProbeClient&) = delete;
  ProbeClient& operator=(const ProbeClient&) = delete;

  bool connected() const { return tcp_ >= 0; }
  int tcp() const { return tcp_; }
  int udp() const { return udp_; }
  std::uint16_t udp_port() const;

  // --- control ----------------------------------------------------------------------------------
  wire::Hello hello(std::uint8_t team = wire::kWatchOnly) const;
  bool say(const wire::ControlMessage& message);
  bool send_raw(std::span<const std::byte> bytes);  // false when the server has closed
  // The next message; nothing at the deadline or when the server has closed.
  std::optional<wire::ControlMessage> hear(int patience_ms = kPatienceMs);
  // The next message of this kind, throwing away others.
  template <class Message>
  std::optional<Message> hear_a(int patience_ms = kPatienceMs) {
    while (auto message = hear(patience_ms)) {
      if (const auto* wanted = std::get_if<Message>(&*message)) return *wanted;
    }
    return std::nullopt;
  }
  // Hello and its answer.
  std::optional<wire::Welcome> join(std::uint8_t team = wire::kWatchOnly);
  // True once the server has closed the connection; throws away what comes before.
  bool sees_close(int patience_ms = kPatienceMs);
  void leave();  // without a word

  // --- datagrams --------------------------------------------------------------------------------
  bool send_input(const wire::InputDatagram& input);
  bool send_datagram(std::span<const std::byte> bytes);
  std::optional<wire::Snapshot> snapshot(int patience_ms = kPatienceMs);

 private:
  std::uint16_t server_port_;
  int tcp_ = -1, udp_ = -1;
  wire::ControlReader reader_;
};

bool wait_readable(int fd, int patience_ms);

}  // namespace server
