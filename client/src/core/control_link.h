// The TCP thread: joins the server, receives its control messages, and joins again after a loss.
#pragma once

#include <atomic>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <thread>

#include "client/connection.h"
#include "core/snapshot_listener.h"
#include "core/sockets.h"
#include "wire/password_exchange.h"

namespace client {

class ControlLink {
 public:
  ControlLink(const ConnectionOptions& options, const os::SocketAddress& server,
              SnapshotListener& listener);
  ~ControlLink();

  void start() {
    thread_ = std::thread([this] { run(); });
  }
  ConnectionStatus status() const;
  std::vector<wire::Notice> notices() const;
  wire::Roster roster() const;
  std::optional<wire::Tuning> tuning() const;
  std::optional<wire::Game> game() const;
  std::optional<wire::Questionnaire> questionnaire() const;
  std::optional<wire::Report> report() const;
  std::string phones() const;
  std::optional<wire::Devices> take_devices();
  void request(std::uint64_t session, const wire::MatchRequest& request);
  void claim(std::uint64_t session, const wire::Claim& claim);
  void kick(std::uint64_t session, const wire::Kick& kick);
  void choose(std::uint64_t session, const wire::Game& game);
  void join_as(const std::string& name);
  void name(std::uint64_t session, const wire::Names& names);
  void answer(std::uint64_t session, const wire::Answers& answers);
  void ask_devices(std::uint64_t session);

 private:
  enum class Stage : std::uint8_t {
    idle,
    connecting,
    proving,   // waits for a Challenge
    greeting,  // waits for a Welcome
    joined
  };

  void run();
  int wait_ms(std::int64_t now_us) const;
  void on_time(std::int64_t now_us);
  void begin(std::int64_t now_us);
  void on_connected(std::int64_t now_us);
  void on_readable(std::int64_t now_us);
  bool take(std::span<const std::byte> bytes, std::int64_t now_us);
  void knock();
  void send_hello();
  bool on_challenge(const wire::Challenge& challenge, std::int64_t now_us);
  void ask(const wire::ControlMessage& message, std::uint64_t session);
  void watch_silence(std::int64_t now_us);
  bool handle(const wire::ControlMessage& message, std::int64_t now_us);
  void on_welcome(const wire::Welcome& welcome, std::int64_t now_us);
  bool on_characters(const wire::Characters& record, std::int64_t now_us);
  void on_notice(const wire::Notice& notice);
  void drop(const std::string& why, std::int64_t now_us, bool refused = false);
  void queue(const wire::ControlMessage& message);
  void flush(std::int64_t now_us);
  void send_bye();

  const ConnectionOptions options_;
  const os::SocketAddress server_;
  SnapshotListener& listener_;
  Waker waker_;
  std::atomic<bool> stop_{false};

  // Only the thread uses these.
  Stage stage_ = Stage::idle;
  os::FileDescriptor tcp_;
  wire::ControlReader reader_;
  std::vector<std::byte> out_;
  std::unique_ptr<wire::PasswordExchange> exchange_;  // while proving
  std::optional<wire::StreamSealer> sealer_;
  std::optional<wire::StreamOpener> opener_;
  std::int64_t next_try_us_ = 0, deadline_us_ = 0, joined_at_us_ = 0;

  mutable std::mutex mutex_;  // guards all below
  std::string name_;          // to join under
  ConnectionStatus status_;
  std::map<std::uint32_t, wire::Notice> notices_;
  wire::Roster roster_;
  std::optional<wire::Tuning> tuning_;
  std::optional<wire::Game> game_;
  std::optional<wire::Questionnaire> questionnaire_;
  std::optional<wire::Report> report_;
  std::string phones_;                       // of the joined server; empty: not sent
  std::optional<wire::Devices> devices_;     // received, not taken yet
  std::vector<wire::ControlMessage> asked_;  // to be sent

  std::thread thread_;
};

}  // namespace client
