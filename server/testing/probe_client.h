// A client reduced to its sockets, for tests and the loop benchmark: joins, listens, sends what it
// is told, good or bad. Every wait has a deadline and ends as soon as something arrives.
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
  static constexpr int kPatienceMs = 5000;  // long enough for a busy machine; never slept through

  // from: the loopback address it connects from and listens at; to: the server's.
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

  // --- control ----------------------------------------------------------------------------------
  wire::Hello hello(std::uint8_t team = wire::kWatchOnly) const;
  bool say(const wire::ControlMessage& message);
  bool send_raw(std::span<const std::byte> bytes);  // false when the server has closed
  // The next message that is no Roster, no Tuning, no Game, no Report and no list of Characters;
  // nothing at the deadline or when the server has closed.
  std::optional<wire::ControlMessage> hear(int patience_ms = kPatienceMs);
  const wire::Roster& roster() const { return roster_; }  // the last one heard
  const std::optional<wire::Tuning>& tuning() const { return tuning_; }
  const std::optional<wire::Game>& game() const { return game_; }
  const wire::Characters& characters() const { return characters_; }
  const std::optional<wire::Report>& report() const { return report_; }
  // The next message of this kind, throwing away others.
  template <class Message>
  std::optional<Message> hear_a(int patience_ms = kPatienceMs) {
    while (auto message = hear(patience_ms)) {
      if (const auto* wanted = std::get_if<Message>(&*message)) return *wanted;
    }
    return std::nullopt;
  }
  // Until all that the server tells of what this client has said is heard, a Roster too. Two pings:
  // a Roster goes out at the end of a pass, behind the answers to what was read in it. False when
  // the server has closed.
  bool catch_up();
  // Hello and its answer.
  std::optional<wire::Welcome> join(std::uint8_t team = wire::kWatchOnly, std::uint8_t rods = 0);
  std::optional<wire::Welcome> join(const wire::Hello& hello);
  // Again to the seat of that Welcome.
  std::optional<wire::Welcome> resume(const wire::Welcome& before);
  // Knock and its answer: all is sealed from now on. False when the server does not answer so.
  bool prove(const std::string& password, wire::Role role = wire::Role::player);
  // True once the server has closed the connection; throws away what comes before.
  bool sees_close(int patience_ms = kPatienceMs);
  void leave();        // without a word
  void say_goodbye();  // and leave

  // --- datagrams --------------------------------------------------------------------------------
  bool send_input(const wire::InputDatagram& input);  // sealed as the Welcome says
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
