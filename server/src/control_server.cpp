#include "control_server.h"

#include <sys/eventfd.h>
#include <sys/socket.h>

#include <algorithm>
#include <cerrno>
#include <utility>

#include "os/capabilities.h"
#include "os/clock.h"
#include "os/socket_address.h"

namespace server {
namespace {

using State = ControlConnection::State;
using wire::make_sentence;
using wire::SentenceId;

constexpr std::int64_t kClosingUs = 1'000'000;  // time for a rejected peer to read the reason
constexpr std::int64_t kGoodbyeUs = 200'000;    // when the server ends
// Without free descriptors, accept(2) fails at once and poll(2) would spin.
constexpr std::int64_t kAcceptPauseUs = 100'000;
// Log lines caused by untrusted clients: a burst, then one per second.
constexpr int kLinesAtOnce = 20;
constexpr std::int64_t kLineEveryUs = 1'000'000;
// Rosters to all: a burst, then one per interval with all changes since. Each client that joins or
// leaves changes the roster.
constexpr int kRostersAtOnce = 32;
constexpr std::int64_t kRosterEveryUs = 50'000;
// Rejected connections that are not closed yet.
constexpr std::size_t kMaxClosing = 64;

}  // namespace

ControlServer::ControlServer(ControlOptions options, os::FileDescriptor listener,
                             os::FileDescriptor wake)
    : options_(std::move(options)),
      listener_(std::move(listener)),
      wake_(std::move(wake)),
      seats_(options_.layout, options_.access.mixed_teams),
      roster_limit_(kRostersAtOnce, kRosterEveryUs),
      log_limit_(kLinesAtOnce, kLineEveryUs),
      thread_([this] { run(); }) {}

ControlServer::~ControlServer() {
  stop(make_sentence<SentenceId::server_ends>());
}

void ControlServer::notify(wire::Notice::Level level, std::uint32_t topic,
                           const wire::Sentence& text) {
  if (outbound_.push({level, topic, text.text()})) ::eventfd_write(wake_.get(), 1);
}

void ControlServer::clear(std::uint32_t topic, const std::string& text) {
  if (outbound_.push({wire::Notice::Level::cleared, topic, text})) ::eventfd_write(wake_.get(), 1);
}

bool ControlServer::send_tuning(const wire::Tuning& tuning) {
  if (!tunings_.push(wire::Tuning(tuning))) return false;
  ::eventfd_write(wake_.get(), 1);
  return true;
}

bool ControlServer::send_game(const wire::Game& game) {
  if (!games_.push(wire::Game(game))) return false;
  ::eventfd_write(wake_.get(), 1);
  return true;
}

void ControlServer::ask(std::uint32_t match, RodSet cabinet_rods) {
  if (questionnaires_.push({match, cabinet_rods})) ::eventfd_write(wake_.get(), 1);
}

void ControlServer::report(const wire::Report& report) {
  if (reports_.push(report)) ::eventfd_write(wake_.get(), 1);
}

bool ControlServer::adopt(VouchedConnection&& connection) {
  if (stopping_.load(std::memory_order_acquire) || !vouched_.push(std::move(connection)))
    return false;
  ::eventfd_write(wake_.get(), 1);
  return true;
}

void ControlServer::stop(const wire::Sentence& reason) {
  if (!thread_.joinable()) return;
  bye_reason_ = reason.text();
  stopping_.store(true, std::memory_order_release);
  ::eventfd_write(wake_.get(), 1);
  thread_.join();
}

ControlCounters ControlServer::counters() const {
  const auto value = [this](Count which) {
    return counts_[static_cast<std::size_t>(which)].load(std::memory_order_relaxed);
  };
  return {.accepted = value(Count::accepted),
          .joined = value(Count::joined),
          .left = value(Count::left),
          .refused = value(Count::refused),
          .bad_messages = value(Count::bad_messages),
          .timed_out = value(Count::timed_out),
          .gave_up = value(Count::gave_up),
          .slow_dropped = value(Count::slow_dropped),
          .crowded_out = value(Count::crowded_out),
          .wrong_passwords = value(Count::wrong_passwords),
          .lost = value(Count::lost),
          .resumed = value(Count::resumed),
          .requests = value(Count::requests),
          .requests_dropped = value(Count::requests_dropped),
          .answers = value(Count::answers),
          .answers_refused = value(Count::answers_refused),
          .kicked = value(Count::kicked)};
}

// --- the thread

void ControlServer::run() {
  os::drop_capabilities(false);  // untrusted bytes are read here
  while (!stopping_.load(std::memory_order_acquire)) {
    wait();
    watch_kicks(os::monotonic_us());
    publish_notices();
    publish_tuning();
    publish_game();
    follow_the_day();
    publish_questionnaires();
    publish_report();
    publish_devices();
    for (std::size_t i = 0; i < connections_.size(); ++i) {
      if (polled_[i + 2].revents & (POLLIN | POLLHUP | POLLERR)) serve(*connections_[i]);
    }
    if (polled_[1].revents & POLLIN) accept_all();
    admit_vouched();
    for (auto& connection : connections_) {
      expire(*connection);
      if (connection->state != State::dead && !connection->flush()) {
        drain(*connection);
        if (connection->state != State::dead) release(*connection, Going::lost);
      }
    }
    watch_seats();
    if (roster_changed_ && roster_limit_.take(os::monotonic_us())) send_roster();
    drop_those_who_do_not_read();
    std::erase_if(connections_, [](const auto& c) { return c->state == State::dead; });
    push_events();
  }
  send_goodbye();
}

void ControlServer::wait() {
  const std::int64_t now = os::monotonic_us();
  const bool accepting = now >= accept_after_us_;
  std::int64_t until = accepting ? now + 60'000'000 : accept_after_us_;
  if (!pending_.empty()) until = std::min(until, now + 10'000);
  constexpr std::int64_t kLookAtSeatsUs = 100'000;
  const bool waiting =
      votes_.any() || kicks_.any() || std::ranges::any_of(seats_.all(), &Seat::away);
  if (waiting) until = std::min(until, now + kLookAtSeatsUs);
  if (roster_changed_) until = std::min(until, now + kRosterEveryUs);
  if (in_challenge()) until = std::min(until, now + kLookAtTheDayUs);
  polled_.clear();
  polled_.push_back({wake_.get(), POLLIN, 0});
  polled_.push_back({accepting ? listener_.get() : -1, POLLIN, 0});
  for (const auto& connection : connections_) {
    const auto events = static_cast<short>(POLLIN | (connection->wants_to_send() ? POLLOUT : 0));
    polled_.push_back({connection->fd(), events, 0});
    if (connection->state != State::joined) until = std::min(until, connection->deadline_us);
  }
  const auto wait_ms = static_cast<int>((std::max<std::int64_t>(0, until - now) + 999) / 1000);
  ::poll(polled_.data(), polled_.size(), wait_ms);
  eventfd_t count = 0;
  if (polled_[0].revents & POLLIN) ::eventfd_read(wake_.get(), &count);
}

// Accepts a bounded number per pass, so that a flood of connections does not delay joined clients;
// poll() reports the rest.
void ControlServer::accept_all() {
  constexpr int kAtOnce = 32;
  for (int i = 0; i < kAtOnce; ++i) {
    sockaddr_storage storage{};
    socklen_t size = sizeof storage;
    auto* generic = reinterpret_cast<sockaddr*>(&storage);
    os::FileDescriptor socket(
        ::accept4(listener_.get(), generic, &size, SOCK_NONBLOCK | SOCK_CLOEXEC));
    if (socket) {
      admit(std::move(socket), os::SocketAddress::from(generic, size));
    } else if (errno != ECONNABORTED && errno != EINTR) {
      if (errno != EAGAIN) accept_after_us_ = os::monotonic_us() + kAcceptPauseUs;
      return;
    }
  }
}

void ControlServer::admit(os::FileDescriptor socket, const os::SocketAddress& peer) {
  count(Count::accepted);
  make_room_at_the_door();
  connections_.push_back(std::make_unique<ControlConnection>(
      std::move(socket), peer, os::monotonic_us() + options_.limits.hello_us));
}

void ControlServer::admit_vouched() {
  VouchedConnection vouched;
  while (vouched_.pop(vouched)) {
    admit(std::move(vouched.socket), vouched.peer);
    connections_.back()->vouch(vouched.local_address);
  }
}

// Every new connection is accepted. If too many are greeting, drops the oldest of the network with
// the most of them. A client sends its Hello at once, so it joins before that happens to it.
void ControlServer::make_room_at_the_door() {
  std::map<std::string, int> crowd;
  int greeting = 0;
  std::size_t closing = 0;
  for (const auto& c : connections_) {
    if (c->state == State::greeting) ++greeting, ++crowd[c->peer().network()];
    if (c->state == State::closing) ++closing;
  }
  const auto drop_oldest = [&](const auto& chosen) {
    const auto oldest = std::ranges::find_if(connections_, chosen);
    if (oldest != connections_.end()) connections_.erase(oldest);
  };
  if (closing >= kMaxClosing) {
    drop_oldest([](const auto& c) { return c->state == State::closing; });
  }
  if (greeting < options_.limits.greeting) return;
  // Of networks with equal counts, drops the oldest connection of all. Otherwise the same network
  // would lose each time, and nobody from there could join.
  int max = 0;
  for (const auto& [network, count] : crowd) max = std::max(max, count);
  drop_oldest([&](const auto& c) {
    return c->state == State::greeting && crowd.at(c->peer().network()) == max;
  });
  count(Count::crowded_out);
}

// On this machine no password is needed; but a phone with a token is never the host.
bool ControlServer::trusted(const ControlConnection& connection) const {
  return !connection.vouched() && options_.access.trust_this_machine &&
         connection.peer().is_loopback();
}

void ControlServer::serve(ControlConnection& connection) {
  if (!connection.receive()) {
    if (connection.wrong_password()) {
      count(Count::wrong_passwords);
      log(LogLevel::warning, os::to_text(connection.peer()) + " sent a wrong password");
    } else if (connection.broke_off()) {
      count(Count::bad_messages);
    }
    release(connection, Going::lost);
    return;
  }
  wire::ControlMessage message;
  while (!connection.unread &&
         (connection.state == State::greeting || connection.state == State::joined)) {
    const auto status = connection.next(message);
    if (status == wire::ControlReader::Status::need_more) return;
    if (status == wire::ControlReader::Status::broken) {
      reject(connection, make_sentence<SentenceId::unreadable>());
      return;
    }
    handle(connection, message);
  }
}

// The peer's end may be known before it is read. It comes after the client's last messages, which
// may include a Bye. If the client had not read all it was sent, its end is a reset, and the next
// send fails first.
void ControlServer::drain(ControlConnection& connection) {
  while (connection.state == State::joined && connection.peer_left()) serve(connection);
}

void ControlServer::handle(ControlConnection& connection, const wire::ControlMessage& message) {
  const bool joined = connection.state == State::joined;
  if (const auto* hello = std::get_if<wire::Hello>(&message); hello && !joined) {
    greet(connection, *hello);
  } else if (const auto* knock = std::get_if<wire::Knock>(&message);
             knock && !joined && !connection.sealed()) {
    answer_knock(connection, *knock);
  } else if (const auto* claim = std::get_if<wire::Claim>(&message); claim && joined) {
    take_claim(connection, *claim);
  } else if (const auto* names = std::get_if<wire::Names>(&message); names && joined) {
    take_names(connection, *names);
  } else if (const auto* ping = std::get_if<wire::Ping>(&message); ping && joined) {
    send(connection, wire::Pong{ping->id});
  } else if (const auto* request = std::get_if<wire::MatchRequest>(&message); request && joined) {
    take_request(connection, *request);
  } else if (const auto* game = std::get_if<wire::Game>(&message); game && joined) {
    take_game(connection, *game);
  } else if (const auto* answers = std::get_if<wire::Answers>(&message); answers && joined) {
    take_answers(connection, *answers);
  } else if (const auto* kick = std::get_if<wire::Kick>(&message); kick && joined) {
    take_kick(connection, *kick);
  } else if (joined && std::holds_alternative<wire::DeviceQuery>(message)) {
    take_device_query(connection);
  } else if (std::holds_alternative<wire::Bye>(message)) {
    release(connection, Going::left);
  } else if (!(joined && std::holds_alternative<wire::Pong>(message))) {
    reject(connection, make_sentence<SentenceId::out_of_place>());
  }
}

// Never removes a seat, so that callers may keep references to seats.
void ControlServer::send(ControlConnection& connection, const wire::ControlMessage& message) {
  if (connection.state == State::dead || connection.unread) return;
  connection.unread = !connection.send(message, options_.limits.unsent_bytes);
}

// Each removal sends messages to the others, which may be slow as well: repeat until none is left.
void ControlServer::drop_those_who_do_not_read() {
  for (bool again = true; again;) {
    const auto slow = std::ranges::find_if(
        connections_, [](const auto& c) { return c->unread && c->state != State::dead; });
    again = slow != connections_.end();
    if (!again) continue;
    count(Count::slow_dropped);
    drop(**slow, "does not read what is sent to it");
  }
}

// --- closing connections

void ControlServer::refuse(ControlConnection& connection, wire::Refusal::Code code,
                           const wire::Sentence& reason) {
  count(code == wire::Refusal::Code::bad_message ? Count::bad_messages : Count::refused);
  log(LogLevel::warning, "refused " + os::to_text(connection.peer()) + ": " + reason.text());
  send(connection, wire::Refusal{code, reason.text()});
  if (connection.client != 0) release(connection, Going::left);
  connection.close_softly(os::monotonic_us() + kClosingUs);
}

// Logs a line caused by an untrusted client, within a rate limit.
void ControlServer::log(LogLevel level, const std::string& text) {
  if (!log_limit_.take(os::monotonic_us())) {
    ++unsaid_;
    return;
  }
  const std::uint64_t unsaid = std::exchange(unsaid_, 0);
  options_.log(level, unsaid == 0 ? text
                                  : text + " (" + std::to_string(unsaid) +
                                        " similar lines were omitted before it)");
}

void ControlServer::reject(ControlConnection& connection, const wire::Sentence& reason) {
  refuse(connection, wire::Refusal::Code::bad_message, reason);
}

void ControlServer::drop(ControlConnection& connection, const std::string& why) {
  const Seat* seat = seats_.find(connection.client);
  log(LogLevel::warning, (seat != nullptr ? seat->name + " at " : std::string()) +
                             os::to_text(connection.peer()) + " is dropped: it " + why);
  release(connection, Going::left);
}

// Detaches the connection from its client. A player who did not send a Bye may return.
void ControlServer::release(ControlConnection& connection, Going going) {
  connection.state = State::dead;
  if (connection.client == 0) return;
  const std::uint32_t client = std::exchange(connection.client, 0);
  const Seat* seat = seats_.find(client);
  const bool kept =
      going == Going::lost && seat != nullptr && seat->plays() && options_.limits.seat_kept_us > 0;
  kept ? lose_seat(client) : give_up_seat(client);
}

void ControlServer::expire(ControlConnection& connection) {
  const bool waits = connection.state == State::greeting || connection.state == State::closing;
  if (!waits || os::monotonic_us() < connection.deadline_us) return;
  if (connection.state == State::greeting) count(Count::timed_out);
  release(connection, Going::lost);
}

// --- between the threads

void ControlServer::publish_notices() {
  wire::Notice notice;
  while (outbound_.pop(notice)) {
    const bool cleared = notice.level == wire::Notice::Level::cleared;
    options_.log(cleared ? LogLevel::info : LogLevel::warning, notice.text);
    publish(notice);
  }
}

// The last of several counts.
void ControlServer::publish_tuning() {
  wire::Tuning tuning;
  bool any = false;
  while (tunings_.pop(tuning)) any = true;
  if (!any) return;
  tuning_ = tuning;
  for (auto& connection : connections_) {
    if (connection->state == State::joined) send(*connection, tuning);
  }
}

void ControlServer::publish_game() {
  wire::Game game;
  bool any = false;
  while (games_.pop(game)) any = true;
  if (!any) return;
  game_ = game;
  for (auto& connection : connections_) {
    if (connection->state == State::joined) send(*connection, game);
  }
}

void ControlServer::publish_report() {
  wire::Report report;
  bool any = false;
  while (reports_.pop(report)) any = true;
  if (!any) return;
  report_ = std::move(report);
  for (auto& connection : connections_) {
    if (connection->state == State::joined) send(*connection, *report_);
  }
}

void ControlServer::publish(wire::Notice::Level level, std::uint32_t topic,
                            const wire::Sentence& text) {
  publish({level, topic, text.text()});
}

// why: for readers of the messages; clients do not show it.
void ControlServer::clear_notice(std::uint32_t topic, const std::string& why) {
  publish({wire::Notice::Level::cleared, topic, why});
}

void ControlServer::answer(ControlConnection& connection, std::uint32_t topic,
                           const wire::Sentence& text) {
  send(connection, wire::Notice{wire::Notice::Level::info, topic, text.text()});
}

// Sends to all, and until cleared to each client that joins.
void ControlServer::publish(const wire::Notice& notice) {
  for (auto& connection : connections_) {
    if (connection->state == State::joined) send(*connection, notice);
  }
  if (notice.level == wire::Notice::Level::cleared) {
    notices_.erase(notice.topic);
  } else {
    notices_[notice.topic] = notice;
  }
}

void ControlServer::push_events() {
  while (!pending_.empty() && events_.room() > 0) {
    events_.push(std::move(pending_.front()));
    pending_.pop_front();
  }
}

void ControlServer::send_goodbye() {
  publish_notices();
  for (auto& connection : connections_) {
    if (connection->state == State::joined) send(*connection, wire::Bye{bye_reason_});
    if (connection->state == State::joined) {
      connection->close_softly(0);
    }
  }
  const std::int64_t until = os::monotonic_us() + kGoodbyeUs;
  const auto unsent = [](const auto& c) {
    return c->flush() && (c->wants_to_send() || os::unacknowledged(c->fd()));
  };
  // Each is flushed in each round, whether or not one before it is still unsent.
  while (std::count_if(connections_.begin(), connections_.end(), unsent) > 0 &&
         os::monotonic_us() < until) {
    ::poll(nullptr, 0, 1);
  }
}

}  // namespace server
