// The control port: a thread of its own that speaks wire/control.h with every client over TCP and
// hands the tick's thread what concerns the match, through queues that never wait.
//
// poll(2) in place of an asynchronous library: one thread, some hundred connections at most, each a
// reader, a capped buffer and a deadline. See docs/decisions/0010 and 0040.
//
// Who connects is at the door until it has said Hello; who has, has a seat (seats.h). The two have
// limits of their own, so that a crowd at the door takes nobody's place inside.
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
    away,  // lost, and expected back: its rods hold
    back,  // with new keys
    rods,  // has others now
    name,  // of who plays these rods, or of the client
    left,  // for good
    request,
    game,     // can be played, as far as can be known before the tick
    answers,  // to the questionnaire
  };
  Kind kind = Kind::joined;
  // Counts up, never used twice. Of a request: whose it is; 0: it was voted for.
  std::uint32_t client = 0;
  std::uint8_t team = wire::kWatchOnly;         // joined, rods
  RodSet rods = 0;                              // joined, back, rods: all that it has
                                                // name: whose it is; none: the client's own
  std::uint64_t token = 0;                      // joined, back, rods
  std::array<char, wire::kMaxName + 1> name{};  // joined, rods, name: ended by a zero
  wire::SealKey input_key{}, snapshot_key{};
  os::FileDescriptor socket;    // joined, back, rods: of who has rods for the first time
  os::SocketAddress listener;   // joined, back: where its snapshots go; port 0: nowhere
  os::SocketAddress heard_at;   // joined, back: from where; of this machine's addresses
  foosball::Command request{};  // request
  wire::Game game;              // game: date: of a challenge
  bool put_out = false;         // left: by others, not of its own will
  wire::Answers answers;        // answers: of one team's rods that were asked and had not answered
};

struct ControlOptions {
  ControlLimits limits;
  AccessOptions access;
  std::uint64_t session = 0;
  int udp = -1;  // the port's UDP socket, which must outlive the server
  std::uint16_t udp_port = 0;
  foosball::Layout layout{};
  wire::Characters characters;        // said to each who joins
  GameSite site;                      // at the start
  std::function<std::string()> date;  // ServerOptions::date; called on the control thread
  std::uint32_t challenge_date = 0;   // ServerOptions::challenge_date
  std::optional<Endpoint> multicast;
  wire::SealKey group_key{};              // with multicast: everybody's
  bool teams_open = true;                 // false: a recording plays, nobody can take a team
  std::string phones;                     // where phones join, for players to see; empty: nowhere
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
  // Sent to all and, until cleared, to each who joins. Dropped and counted if 64 are waiting.
  void notify(wire::Notice::Level level, std::uint32_t topic, const wire::Sentence& text);
  void clear(std::uint32_t topic, const std::string& text);  // text: for the log
  // Sent to all, and to each who joins until another is. False: try again in the next tick.
  bool tell_tuning(const wire::Tuning& tuning);
  bool tell_game(const wire::Game& game);  // the same
  // A match was won that is kept: who has rods may answer. cabinet_rods: those that its own hands
  // have, who are asked at the first host's at this machine. Left out if 8 are waiting.
  void ask(std::uint32_t match, RodSet cabinet_rods);
  // The same for a report; left out if 8 are waiting.
  void report(const wire::Report& report);
  // A host has asked for them since the last tell_devices().
  bool devices_asked() const { return devices_asked_.load(std::memory_order_acquire); }
  void tell_devices(const DeviceTable& table);
  // A match that was played is over: who was put out may play again.
  void match_is_over();
  // A connection that another port has let in, as a player's: it says Hello as any other, needs no
  // password, and is never the host. One thread of its own. False: 16 are waiting, or it ends.
  bool adopt(VouchedConnection&& connection);
  // Says Bye to all, waits a moment for it to be sent, and ends the thread.
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

  // How a client goes: for good, or lost, so that its seat is kept.
  enum class Going : std::uint8_t { left, lost };

  // control_server.cpp: the thread, the door, the ends of connections, notices
  void run();
  void wait();
  void accept_all();
  void admit(os::FileDescriptor socket, const os::SocketAddress& peer);
  void admit_vouched();
  void make_room_at_the_door();
  bool trusted(const ControlConnection& connection) const;
  void serve(ControlConnection& connection);
  void hear_out(ControlConnection& connection);
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
  void tell(wire::Notice::Level level, std::uint32_t topic, const wire::Sentence& text);
  void clear_notice(std::uint32_t topic, const std::string& why);
  void publish(const wire::Notice& notice);
  void answer(ControlConnection& connection, std::uint32_t topic, const wire::Sentence& text);
  void tell_tick();
  void log(LogLevel level, const std::string& text);
  void say_goodbye();

  // control_table.cpp: who sits where, and who may what
  void answer_knock(ControlConnection& connection, const wire::Knock& knock);
  void greet(ControlConnection& connection, const wire::Hello& hello);
  bool resume(ControlConnection& connection, const wire::Hello& hello);
  bool admit_to_table(ControlConnection& connection, const wire::Hello& hello, RodSet& rods);
  static std::string owner_of(const ControlConnection& connection);
  void hear_out_leavers(RodSet wanted);
  void join(ControlConnection& connection, const wire::Hello& hello, RodSet rods);
  bool welcome(ControlConnection& connection, Seat& seat, ControlEvent::Kind kind,
               std::uint16_t udp_port);
  os::FileDescriptor client_socket(const ControlConnection& connection,
                                   const os::SocketAddress& listener);
  void take_claim(ControlConnection& connection, const wire::Claim& claim);
  void take_names(ControlConnection& connection, const wire::Names& names);
  void tell_name(const Seat& seat, RodSet rods, const std::string& name);
  void take_request(ControlConnection& connection, const wire::MatchRequest& request);
  void take_game(ControlConnection& connection, wire::Game game);
  void choose(const wire::Game& game, std::uint32_t client);
  bool in_challenge() const;
  std::uint32_t challenge_day() const;  // that of a challenge chosen now; 0: unknown
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
  std::map<std::uint32_t, wire::Notice> notices_;  // standing, by topic
  std::deque<ControlEvent> untold_;                // the tick has not been told yet
  std::vector<pollfd> polled_;
  std::uint32_t last_client_ = 0;
  std::int64_t accept_after_us_ = 0;
  bool roster_changed_ = false;
  RateLimit roster_limit_;
  // Events that may wait for the tick, which takes eight a millisecond: beyond, nobody joins.
  static constexpr std::size_t kMostUntold = 256;
  static constexpr std::int64_t kLookAtTheDayUs = 1'000'000;
  std::int64_t look_at_the_day_us_ = 0;
  std::uint32_t followed_day_ = 0;
  RateLimit log_limit_;
  std::uint64_t unsaid_ = 0;  // lines that the log was spared

  SpscQueue<ControlEvent, 1024> events_;
  SpscQueue<VouchedConnection, 16> vouched_;
  SpscQueue<wire::Notice, 64> outbound_;
  SpscQueue<wire::Tuning, 8> tunings_;
  SpscQueue<wire::Game, 8> games_;
  std::optional<wire::Game> game_;  // as it was last told
  std::atomic<bool> devices_asked_{false};
  SpscQueue<DeviceTable, 2> devices_;
  DeviceTable device_table_;  // taken out of it
  SpscQueue<wire::Report, 8> reports_;
  std::optional<wire::Report> report_;                // the last one
  SpscQueue<wire::Questionnaire, 8> questionnaires_;  // rods: the cabinet's
  std::optional<wire::Tuning> tuning_;                // of the match, as it was last told
  std::array<std::atomic<std::uint64_t>, static_cast<std::size_t>(Count::kCount)> counts_{};
  std::atomic<bool> stopping_{false};
  std::string bye_reason_;  // written before stopping_
  std::thread thread_;
};

}  // namespace server
