// The control port: a thread of its own that speaks wire/control.h with every client over TCP and
// hands the tick's thread what concerns the match, through queues that never wait.
//
// poll(2) in place of an asynchronous library: one thread, at most 32 connections, each a reader, a
// capped buffer and a deadline. See docs/decisions/0010.
#pragma once

#include <netinet/in.h>
#include <poll.h>

#include <array>
#include <atomic>
#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <string>
#include <thread>
#include <vector>

#include "control_connection.h"
#include "foosball/match.h"
#include "os/file_descriptor.h"
#include "server/counters.h"
#include "server/log.h"
#include "server/network.h"
#include "server/spsc_queue.h"
#include "wire/control.h"

namespace server {

// From the control thread to the tick.
struct ControlEvent {
  enum class Kind : std::uint8_t { joined, left, wish };
  Kind kind = Kind::joined;
  std::uint32_t client = 0;                     // counts up, never used twice
  std::uint8_t team = wire::kWatchOnly;         // joined: granted
  std::uint64_t token = 0;                      // joined
  std::array<char, wire::kMaxName + 1> name{};  // joined: what it calls itself, ended by a zero
  sockaddr_in listener{};                       // joined: where its snapshots go; port 0: nowhere
  foosball::Command wish{};                     // wish
};

struct ControlOptions {
  ControlLimits limits;
  std::uint64_t session = 0;
  std::uint16_t udp_port = 0;
  foosball::Layout layout{};
  std::optional<Endpoint> multicast;
  bool teams_open = true;                 // false: a recording plays, nobody can take a team
  std::function<std::uint64_t()> random;  // tokens; called on the control thread
  Log log;                                // called on the control thread
};

class ControlServer {
 public:
  // wake: a non-blocking eventfd.
  ControlServer(ControlOptions options, os::FileDescriptor listener, os::FileDescriptor wake);
  ~ControlServer();

  // Tick thread.
  bool next_event(ControlEvent& event) { return events_.pop(event); }
  // Sent to all and, until cleared, to each who joins. Dropped and counted if 64 are waiting.
  void notify(wire::Notice notice);
  // Says Bye to all, waits a moment for it to be sent, and ends the thread.
  void stop(const std::string& reason);

  ControlCounters counters() const;  // any thread

 private:
  using Connections = std::vector<std::unique_ptr<ControlConnection>>;
  enum class Count : std::size_t {
    accepted,
    joined,
    left,
    refused,
    bad_messages,
    timed_out,
    gave_up,
    slow_dropped,
    wishes,
    wishes_dropped,
    kCount
  };

  void run();
  void wait();
  void accept_all();
  void admit(os::FileDescriptor socket, const sockaddr_in& peer);
  int connections_from(const sockaddr_in& peer) const;
  void serve(ControlConnection& connection);
  void handle(ControlConnection& connection, const wire::ControlMessage& message);
  void greet(ControlConnection& connection, const wire::Hello& hello);
  bool grant_team(ControlConnection& connection, std::uint8_t team);
  void release_team_of_a_leaver(std::uint8_t team);
  void join(ControlConnection& connection, const wire::Hello& hello);
  void take_wish(ControlConnection& connection, const wire::Wish& wish);
  void send(ControlConnection& connection, const wire::ControlMessage& message);
  void refuse(ControlConnection& connection, wire::Refusal::Code code, const std::string& reason);
  void reject(ControlConnection& connection, const std::string& reason);
  void drop(ControlConnection& connection, const std::string& why);
  void release(ControlConnection& connection);
  void expire(ControlConnection& connection);
  void publish_notices();
  void tell_leavers();
  void say_goodbye();
  void count(Count which) {
    counts_[static_cast<std::size_t>(which)].fetch_add(1, std::memory_order_relaxed);
  }

  ControlOptions options_;
  os::FileDescriptor listener_, wake_;
  Connections connections_;
  std::array<std::uint32_t, foosball::kTeams> team_owner_{};  // client; 0 nobody
  std::map<std::uint32_t, wire::Notice> notices_;             // standing, by topic
  std::vector<ControlEvent> leavers_;                         // the tick has not been told yet
  std::vector<pollfd> polled_;
  std::uint32_t last_client_ = 0;
  std::int64_t accept_after_us_ = 0;
  int refusals_logged_ = 0;

  SpscQueue<ControlEvent, 1024> events_;
  SpscQueue<wire::Notice, 64> outbound_;
  std::array<std::atomic<std::uint64_t>, static_cast<std::size_t>(Count::kCount)> counts_{};
  std::atomic<bool> stopping_{false};
  std::string bye_reason_;  // written before stopping_
  std::thread thread_;
};

}  // namespace server
