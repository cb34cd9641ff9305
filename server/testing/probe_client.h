// A minimal client for tests and the loop benchmark: joins, listens, and sends any message, valid
// or not. Every wait has a deadline and ends as soon as something arrives.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>

#include "os/socket_address.h"
#include "wire/control.h"
#include "wire/enums.h"
#include "wire/input_datagram.h"
#include "wire/password_exchange.h"
#include "wire/seal.h"
#include "wire/snapshot.h"

namespace server {

class ProbeClient {
 public:
  static constexpr int kPatienceMs = 5000;  // long enough for a loaded machine

  // from: the loopback address to connect from and to listen at; to: the server's address.
  explicit ProbeClient(std::uint16_t port, const std::string& from = "127.0.0.1",
                       const std::string& to = "127.0.0.1");
  ~ProbeClient();
  ProbeClient(ProbeClient&& other) noexcept;
  ProbeClient(const ProbeClient&) = delete;
  ProbeClient& operator=(const ProbeClient&) = delete;

  bool connected() const { return tcp_ >= 0; }
  int tcp() const { return tcp_; }
  int udp() const { return udp_; }
  std::uint16_t udp_port() const;

  // --- control
  wire::Hello hello(std::uint8_t team = wire::kWatchOnly) const;
  bool send(const wire::ControlMessage& message);
  bool send_raw(std::span<const std::byte> bytes);  // false if the server has closed
  // The next message that is not a Roster, Tuning, Game, Report or list of Characters; nothing at
  // the deadline or if the server has closed.
  std::optional<wire::ControlMessage> receive(int patience_ms = kPatienceMs);
  const wire::Roster& roster() const { return roster_; }  // the last one received
  const std::optional<wire::Tuning>& tuning() const { return tuning_; }
  const std::optional<wire::Game>& game() const { return game_; }
  const wire::Characters& characters() const { return characters_; }
  const std::optional<wire::Report>& report() const { return report_; }
  // The next message of this type; discards others.
  template <class Message>
  std::optional<Message> receive_a(int patience_ms = kPatienceMs) {
    while (auto message = receive(patience_ms)) {
      if (const auto* wanted = std::get_if<Message>(&*message)) return *wanted;
    }
    return std::nullopt;
  }
  // Waits for all effects of this client's messages, including a Roster. Uses two pings: a Roster
  // is sent at the end of a pass, after the answers to that pass's messages. False if the server
  // has closed.
  bool catch_up();
  // Sends a Hello and returns the answer.
  std::optional<wire::Welcome> join(std::uint8_t team = wire::kWatchOnly, std::uint8_t rods = 0);
  std::optional<wire::Welcome> join(const wire::Hello& hello);
  // Resumes the seat of that Welcome.
  std::optional<wire::Welcome> resume(const wire::Welcome& before);
  // Sends a Knock and handles the answer: everything is sealed from then on. False if the server
  // does not answer correctly.
  bool prove(const std::string& password, wire::Role role = wire::Role::player);
  // True once the server has closed the connection; discards earlier messages.
  bool sees_close(int patience_ms = kPatienceMs);
  void leave();         // without a Bye
  void send_goodbye();  // sends a Bye, then leaves

  // --- datagrams
  bool send_input(const wire::InputDatagram& input);  // sealed as the Welcome defines
  std::vector<std::byte> sealed(const wire::InputDatagram& input);
  bool send_datagram(std::span<const std::byte> bytes);
  std::optional<wire::Snapshot> snapshot(int patience_ms = kPatienceMs);

 private:
  os::SocketAddress server_;
  int tcp_ = -1, udp_ = -1;
  wire::ControlReader reader_;
  std::optional<wire::StreamSealer> sealer_;
  std::optional<wire::StreamOpener> opener_;
  wire::Welcome welcome_;
  wire::Roster roster_;
  std::optional<wire::Tuning> tuning_;
  std::optional<wire::Game> game_;
  wire::Characters characters_;
  std::optional<wire::Report> report_;
  wire::DatagramOpener snapshots_;
  std::uint64_t sent_ = 0;
};

bool wait_readable(int fd, int patience_ms);

}  // namespace server
