// The control port: a thread that speaks wire/control.h with every client over TCP. It passes what
// concerns the match to the tick thread, through queues that never block.
//
// It uses poll(2) instead of an asynchronous library: one thread, at most a few hundred
// connections, each with a reader, a bounded buffer and a deadline. See docs/decisions/0010 and
// 0040.
//
// A new connection is in the greeting state until it has sent a Hello; after that it has a seat
// (seats.h). Each state has its own limits, so that a flood of new connections cannot take a
// player's seat.
#pragma once

#include <poll.h>

#include <array>
#include <atomic>
#include <cstdint>
#include <deque>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "control_connection.h"
#include "device_table.h"
#include "door.h"
#include "foosball/match.h"
#include "kick_votes.h"
#include "os/file_descriptor.h"
#include "seats.h"
#include "server/counters.h"
#include "server/game_choice.h"
#include "server/log.h"
#include "server/network.h"
#include "server/spsc_queue.h"
#include "votes.h"
#include "vouched_connection.h"
#include "wire/control.h"
#include "wire/seal.h"
#include "wire/sentence.h"

namespace server {

// From the control thread to the tick.
struct ControlEvent {
  enum class Kind : std::uint8_t {
    joined,
    away,  // lost, seat reserved: its rods hold
    back,  // with new keys
    rods,  // changed
    name,  // of the player of these rods, or of the client
    left,  // for good
    request,
    game,     // valid, as far as known before the tick
    answers,  // to the questionnaire
  };
  Kind kind = Kind::joined;
  // Increases, never reused. Of a request: its client; 0: a vote decided it.
  std::uint32_t client = 0;
  std::uint8_t team = wire::kWatchOnly;         // joined, rods
  RodSet rods = 0;                              // joined, back, rods: all its rods
                                                // name: rods of that player; none: the client
                                                // itself
  std::uint64_t token = 0;                      // joined, back, rods
  std::array<char, wire::kMaxName + 1> name{};  // joined, rods, name: zero-terminated
  wire::SealKey input_key{}, snapshot_key{};
  os::FileDescriptor socket;        // joined, back, rods: when it gets rods for the first time
  os::SocketAddress listener;       // joined, back: destination of its snapshots; port 0: none
  os::SocketAddress local_address;  // joined, back: local address that received it
  foosball::Command request{};      // request
  wire::Game game;                  // game: date: of a challenge
  bool put_out = false;             // left: removed by others
  wire::Answers answers;            // answers: for rods of one team, asked and not yet answered
};

struct ControlOptions {
  ControlLimits limits;
  AccessOptions access;
  std::uint64_t session = 0;
  int udp = -1;  // the port's UDP socket, which must outlive the server
  std::uint16_t udp_port = 0;
  foosball::Layout layout{};
  wire::Characters characters;        // sent to each client that joins
  GameSite site;                      // at the start
  std::function<std::string()> date;  // ServerOptions::date; called on the control thread
  std::uint32_t challenge_date = 0;   // ServerOptions::challenge_date
  std::optional<Endpoint> multicast;
  wire::SealKey group_key{};              // with multicast: shared by all clients
  bool teams_open = true;                 // false: a replay is shown, and no team can be taken
  std::string phones;                     // where phones join, shown to players; empty: not open
  std::function<std::uint64_t()> random;  // secrets; called on the control thread
  Log log;                                // called on the control thread
};

class ControlServer {
 public:
  // wake: a non-blocking eventfd.
  ControlServer(ControlOptions options, os::FileDescriptor listener, os::FileDescriptor wake);
  ~ControlServer();

  // Tick thread.
  bool next_event(ControlEvent& event) { return events_.pop(event); }
  // Sent to all, and until cleared to each client that joins. Dropped and counted if 64 are
  // pending.
  void notify(wire::Notice::Level level, std::uint32_t topic, const wire::Sentence& text);
  void clear(std::uint32_t topic, const std::string& text);  // text: for the log
  // Sent to all, and to each client that joins until it is replaced. False: retry in the next tick.
  bool send_tuning(const wire::Tuning& tuning);
  bool send_game(const wire::Game& game);  // the same
  // A match that is stored was won: asks the clients that have rods. cabinet_rods: rods of the
  // server's own devices, whose players are asked at the first host on this machine. Dropped if 8
  // are pending.
  void ask(std::uint32_t match, RodSet cabinet_rods);
  // The same for a report; dropped if 8 are pending.
  void report(const wire::Report& report);
  // True if a host has requested the devices since the last report_devices().
  bool devices_asked() const { return devices_asked_.load(std::memory_order_acquire); }
  void report_devices(const DeviceTable& table);
  // A match that was played is over: removed players may play again.
  void match_is_over();
  // Takes a connection that another port has accepted, with the rights of a player: it sends a
  // Hello like any other, needs no password, and is never the host. Call from one thread. False: 16
  // are pending, or the server is ending.
  bool adopt(VouchedConnection&& connection);
  // Sends Bye to all, waits briefly until it is sent, and ends the thread.
  void stop(const wire::Sentence& reason);

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
    requests,
    requests_dropped,
    crowded_out,
    wrong_passwords,
    lost,
    resumed,
    answers,
    answers_refused,
    kicked,
    kCount
  };

  // How a client goes: for good, or lost with a reserved seat.
  enum class Going : std::uint8_t { left, lost };

  // control_server.cpp: the thread, new connections, closing connections, notices
  void run();
  void wait();
  void accept_all();
  void admit(os::FileDescriptor socket, const os::SocketAddress& peer);
  void admit_vouched();
  void make_room_at_the_door();
  bool trusted(const ControlConnection& connection) const;
  void serve(ControlConnection& connection);
  void drain(ControlConnection& connection);
  void handle(ControlConnection& connection, const wire::ControlMessage& message);
  void send(ControlConnection& connection, const wire::ControlMessage& message);
  void refuse(ControlConnection& connection, wire::Refusal::Code code,
              const wire::Sentence& reason);
  void reject(ControlConnection& connection, const wire::Sentence& reason);
  void drop(ControlConnection& connection, const std::string& why);
  void drop_those_who_do_not_read();
  void release(ControlConnection& connection, Going going);
  void expire(ControlConnection& connection);
  void publish_notices();
  void publish_tuning();
  void publish_game();
  void publish_questionnaires();
  void publish_report();
  void publish(wire::Notice::Level level, std::uint32_t topic, const wire::Sentence& text);
  void clear_notice(std::uint32_t topic, const std::string& why);
  void publish(const wire::Notice& notice);
  void answer(ControlConnection& connection, std::uint32_t topic, const wire::Sentence& text);
  void push_events();
  void log(LogLevel level, const std::string& text);
  void send_goodbye();

  // control_table.cpp: seats and permissions
  void answer_knock(ControlConnection& connection, const wire::Knock& knock);
  void greet(ControlConnection& connection, const wire::Hello& hello);
  bool resume(ControlConnection& connection, const wire::Hello& hello);
  bool admit_to_table(ControlConnection& connection, const wire::Hello& hello, RodSet& rods);
  static std::string owner_of(const ControlConnection& connection);
  void drain_leavers(RodSet wanted);
  void join(ControlConnection& connection, const wire::Hello& hello, RodSet rods);
  bool welcome(ControlConnection& connection, Seat& seat, ControlEvent::Kind kind,
               std::uint16_t udp_port);
  os::FileDescriptor client_socket(const ControlConnection& connection,
                                   const os::SocketAddress& listener);
  void take_claim(ControlConnection& connection, const wire::Claim& claim);
  void take_names(ControlConnection& connection, const wire::Names& names);
  void report_name(const Seat& seat, RodSet rods, const std::string& name);
  void take_request(ControlConnection& connection, const wire::MatchRequest& request);
  void take_game(ControlConnection& connection, wire::Game game);
  void choose(const wire::Game& game, std::uint32_t client);
  bool in_challenge() const;
  std::uint32_t challenge_day() const;  // of a challenge chosen now; 0: unknown
  void follow_the_day();
  void take_answers(ControlConnection& connection, const wire::Answers& answers);
  // control_devices.cpp
  void publish_devices();
  void take_device_query(ControlConnection& connection);
  // control_kicks.cpp
  void take_kick(ControlConnection& connection, const wire::Kick& kick);
  wire::Sentence why_not_kick(const Seat& voter, const Seat* target) const;
  void put_out(Seat& seat, bool by_host);
  wire::Sentence why_out(const std::string& owner, wire::Role role, std::uint32_t client) const;
  KickVotes::Here here() const;
  void watch_kicks(std::int64_t now_us);
  void carry_vote_over(const Seat& newcomer);

  bool put_to_vote(const Seat& seat, const foosball::Command& command);
  bool hand_on(std::uint32_t client, const foosball::Command& command);
  void lose_seat(std::uint32_t client);
  void give_up_seat(std::uint32_t client);
  void watch_seats();
  void send_roster();
  wire::SealKey random_key();
  void count(Count which) {
    counts_[static_cast<std::size_t>(which)].fetch_add(1, std::memory_order_relaxed);
  }

  ControlOptions options_;
  os::FileDescriptor listener_, wake_;
  Connections connections_;
  Seats seats_;
  Votes votes_;
  KickVotes kicks_;
  std::atomic<std::uint32_t> matches_over_{0};
  std::uint32_t matches_over_seen_ = 0;
  PasswordTries password_tries_;
  std::map<std::uint32_t, wire::Notice> notices_;  // active, by topic
  std::deque<ControlEvent> pending_;               // not yet passed to the tick
  std::vector<pollfd> polled_;
  std::uint32_t last_client_ = 0;
  std::int64_t accept_after_us_ = 0;
  bool roster_changed_ = false;
  RateLimit roster_limit_;
  // Limit of events pending for the tick, which takes eight per millisecond. Above it, nobody may
  // join.
  static constexpr std::size_t kMaxPending = 256;
  static constexpr std::int64_t kLookAtTheDayUs = 1'000'000;
  std::int64_t look_at_the_day_us_ = 0;
  std::uint32_t followed_day_ = 0;
  RateLimit log_limit_;
  std::uint64_t unsaid_ = 0;  // number of suppressed log lines

  SpscQueue<ControlEvent, 1024> events_;
  SpscQueue<VouchedConnection, 16> vouched_;
  SpscQueue<wire::Notice, 64> outbound_;
  SpscQueue<wire::Tuning, 8> tunings_;
  SpscQueue<wire::Game, 8> games_;
  std::optional<wire::Game> game_;  // as last sent
  std::atomic<bool> devices_asked_{false};
  SpscQueue<DeviceTable, 2> devices_;
  DeviceTable device_table_;  // taken from devices_
  SpscQueue<wire::Report, 8> reports_;
  std::optional<wire::Report> report_;                // the latest one
  SpscQueue<wire::Questionnaire, 8> questionnaires_;  // rods: the cabinet's
  std::optional<wire::Tuning> tuning_;                // of the match, as last sent
  std::array<std::atomic<std::uint64_t>, static_cast<std::size_t>(Count::kCount)> counts_{};
  std::atomic<bool> stopping_{false};
  std::string bye_reason_;  // written before stopping_
  std::thread thread_;
};

}  // namespace server
