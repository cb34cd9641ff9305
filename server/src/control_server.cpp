#include "control_server.h"

#include <sys/eventfd.h>
#include <sys/socket.h>

#include <algorithm>
#include <cerrno>

#include "os/clock.h"
#include "os/socket_address.h"
#include "wire/snapshot.h"
#include "wish_rules.h"

namespace server {
namespace {

using State = ControlConnection::State;

constexpr std::int64_t kClosingUs = 1'000'000;  // a peer told to go may take so long to read why
constexpr std::int64_t kGoodbyeUs = 200'000;    // at our own end
// Without descriptors left, accept(2) fails at once and poll(2) would spin.
constexpr std::int64_t kAcceptPauseUs = 100'000;
// Places in the queue to the tick that wishes leave free, so that who joined and left gets through.
constexpr std::size_t kRoomForMembers = 256;
constexpr int kMaxRefusalsLogged = 20;

// A stranger's name, fit for a log.
std::string printable(const std::string& name) {
  std::string text = name.empty() ? "unnamed" : name;
  for (char& c : text) {
    if (static_cast<unsigned char>(c) < 0x20 || c == 0x7f) c = '?';
  }
  return text;
}

}  // namespace

ControlServer::ControlServer(ControlOptions options, os::FileDescriptor listener,
                             os::FileDescriptor wake)
    : options_(std::move(options)),
      listener_(std::move(listener)),
      wake_(std::move(wake)),
      thread_([this] { run(); }) {}

ControlServer::~ControlServer() {
  stop("the server ends");
}

void ControlServer::notify(wire::Notice notice) {
  if (outbound_.push(std::move(notice))) ::eventfd_write(wake_.get(), 1);
}

void ControlServer::stop(const std::string& reason) {
  if (!thread_.joinable()) return;
  bye_reason_ = reason;
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
          .wishes = value(Count::wishes),
          .wishes_dropped = value(Count::wishes_dropped)};
}

// --- the thread
// -----------------------------------------------------------------------------------

void ControlServer::run() {
  while (!stopping_.load(std::memory_order_acquire)) {
    wait();
    publish_notices();
    for (std::size_t i = 0; i < connections_.size(); ++i) {
      if (polled_[i + 2].revents & (POLLIN | POLLHUP | POLLERR)) serve(*connections_[i]);
    }
    if (polled_[1].revents & POLLIN) accept_all();
    for (auto& connection : connections_) {
      expire(*connection);
      if (connection->state != State::dead && !connection->flush()) release(*connection);
    }
    std::erase_if(connections_, [](const auto& c) { return c->state == State::dead; });
    tell_leavers();
  }
  say_goodbye();
}

void ControlServer::wait() {
  const std::int64_t now = os::monotonic_us();
  const bool accepting = now >= accept_after_us_;
  std::int64_t until = accepting ? now + 60'000'000 : accept_after_us_;
  if (!leavers_.empty()) until = std::min(until, now + 10'000);
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

void ControlServer::accept_all() {
  while (true) {
    sockaddr_in peer{};
    socklen_t size = sizeof peer;
    os::FileDescriptor socket(::accept4(listener_.get(), reinterpret_cast<sockaddr*>(&peer), &size,
                                        SOCK_NONBLOCK | SOCK_CLOEXEC));
    if (socket) {
      admit(std::move(socket), peer);
    } else if (errno != ECONNABORTED && errno != EINTR) {
      if (errno != EAGAIN) accept_after_us_ = os::monotonic_us() + kAcceptPauseUs;
      return;
    }
  }
}

// Attempts that were given up while this process stood still take up nobody's share.
int ControlServer::connections_from(const sockaddr_in& peer) const {
  return static_cast<int>(std::count_if(connections_.begin(), connections_.end(), [&](auto& c) {
    return c->peer().sin_addr.s_addr == peer.sin_addr.s_addr && !c->peer_left();
  }));
}

void ControlServer::admit(os::FileDescriptor socket, const sockaddr_in& peer) {
  count(Count::accepted);
  const auto& limits = options_.limits;
  const int share = os::is_loopback(peer) ? limits.per_local_address : limits.per_address;
  const bool full = static_cast<int>(connections_.size()) >= limits.connections;
  const bool greedy = connections_from(peer) >= share;
  auto connection = std::make_unique<ControlConnection>(std::move(socket), peer,
                                                        os::monotonic_us() + limits.hello_us);
  if (full || greedy) {
    // Told once and forgotten at once: a crowd at the door takes no place inside.
    refuse(*connection, wire::Refusal::Code::full,
           full ? "the server is full: try again when somebody has left"
                : "too many connections from your address: close one first");
    connection->flush();
    return;
  }
  connections_.push_back(std::move(connection));
}

void ControlServer::serve(ControlConnection& connection) {
  if (!connection.receive()) {
    if (connection.broke_off()) count(Count::bad_messages);
    release(connection);
    return;
  }
  wire::ControlMessage message;
  while (connection.state == State::greeting || connection.state == State::joined) {
    const auto status = connection.next(message);
    if (status == wire::ControlReader::Status::need_more) return;
    if (status == wire::ControlReader::Status::broken) {
      reject(connection, "your message could not be read: is this a Space Foosball client?");
      return;
    }
    handle(connection, message);
  }
}

void ControlServer::handle(ControlConnection& connection, const wire::ControlMessage& message) {
  const bool joined = connection.state == State::joined;
  if (const auto* hello = std::get_if<wire::Hello>(&message); hello && !joined) {
    greet(connection, *hello);
  } else if (const auto* ping = std::get_if<wire::Ping>(&message); ping && joined) {
    send(connection, wire::Pong{ping->id});
  } else if (const auto* wish = std::get_if<wire::Wish>(&message); wish && joined) {
    take_wish(connection, *wish);
  } else if (std::holds_alternative<wire::Bye>(message)) {
    release(connection);
  } else if (!(joined && std::holds_alternative<wire::Pong>(message))) {
    reject(connection, "a message out of its place: say Hello first and once");
  }
}

void ControlServer::greet(ControlConnection& connection, const wire::Hello& hello) {
  connection.name = printable(hello.name);
  // Whoever gave up waiting has asked anew since, and must not find its place taken by its own
  // ghost.
  if (connection.peer_left()) {
    count(Count::gave_up);
    release(connection);
    return;
  }
  if (hello.version != wire::kControlVersion) {
    refuse(connection, wire::Refusal::Code::version,
           "this server speaks control version " + std::to_string(wire::kControlVersion) +
               ", you speak " + std::to_string(hello.version) + ": use the same release of both");
  } else if (hello.snapshot_layout != wire::snapshot_layout_hash()) {
    refuse(connection, wire::Refusal::Code::layout,
           "your snapshots are laid out otherwise: use the same release of both");
  } else if (events_.room() <= kRoomForMembers / 2 || !leavers_.empty()) {
    refuse(connection, wire::Refusal::Code::full, "the server is overloaded: try again");
  } else if (grant_team(connection, hello.team)) {
    join(connection, hello);
  }
}

// True when the client may go on: as a watcher, or with the team that was free.
bool ControlServer::grant_team(ControlConnection& connection, std::uint8_t team) {
  if (team == wire::kWatchOnly) return true;
  if (team >= foosball::kTeams) {
    reject(connection, "there is no such team: ask for 0, 1 or 255 to watch");
    return false;
  }
  if (!options_.teams_open) {
    refuse(connection, wire::Refusal::Code::team_taken, "a recording plays here: join to watch");
    return false;
  }
  release_team_of_a_leaver(team);
  if (team_owner_[team] != 0) {
    refuse(connection, wire::Refusal::Code::team_taken,
           "team " + std::to_string(team) + " is taken: ask for the other one, or join to watch");
    return false;
  }
  return true;
}

// Its end may be known and not yet read: it comes behind what the client still said.
void ControlServer::release_team_of_a_leaver(std::uint8_t team) {
  for (auto& connection : connections_) {
    if (connection->state == State::joined && connection->team == team && connection->peer_left()) {
      release(*connection);
    }
  }
}

void ControlServer::join(ControlConnection& connection, const wire::Hello& hello) {
  connection.state = State::joined;
  connection.client = ++last_client_;
  connection.team = hello.team;
  if (hello.team != wire::kWatchOnly) team_owner_[hello.team] = connection.client;

  ControlEvent event;
  event.kind = ControlEvent::Kind::joined;
  event.client = connection.client;
  event.team = connection.team;
  event.token = options_.random();
  connection.name.copy(event.name.data(), event.name.size() - 1);
  event.listener = connection.peer();
  event.listener.sin_port = htons(hello.udp_port);
  events_.push(event);  // before the Welcome: who has it is in the very next tick

  wire::Welcome welcome;
  welcome.session = options_.session;
  welcome.token = event.token;
  welcome.udp_port = options_.udp_port;
  welcome.layout = static_cast<std::uint8_t>(options_.layout);
  welcome.team = connection.team;
  if (options_.multicast) {
    welcome.multicast = options_.multicast->address;
    welcome.multicast_port = options_.multicast->port;
  }
  send(connection, welcome);
  for (const auto& [topic, notice] : notices_) send(connection, notice);
  count(Count::joined);
  options_.log(LogLevel::info, connection.name + " at " + os::to_text(connection.peer()) +
                                   (connection.team == wire::kWatchOnly
                                        ? " watches"
                                        : " plays team " + std::to_string(connection.team)));
}

void ControlServer::take_wish(ControlConnection& connection, const wire::Wish& wish) {
  if (!well_formed(wish)) {
    reject(connection, "a wish that does not exist: use the same release of client and server");
    return;
  }
  ControlEvent event;
  event.kind = ControlEvent::Kind::wish;
  event.client = connection.client;
  event.wish = {static_cast<foosball::Command::Kind>(wish.kind), wish.team, wish.value};
  const bool taken = may_wish(connection.team, os::is_loopback(connection.peer()), event.wish) &&
                     connection.wishes.take(os::monotonic_us()) &&
                     events_.room() > kRoomForMembers && events_.push(event);
  count(taken ? Count::wishes : Count::wishes_dropped);
}

void ControlServer::send(ControlConnection& connection, const wire::ControlMessage& message) {
  if (connection.state == State::dead) return;
  if (!connection.send(message, options_.limits.unsent_bytes)) {
    count(Count::slow_dropped);
    drop(connection, "does not read what it is sent");
  }
}

// --- the ends of a connection
// ---------------------------------------------------------------------

void ControlServer::refuse(ControlConnection& connection, wire::Refusal::Code code,
                           const std::string& reason) {
  count(code == wire::Refusal::Code::bad_message ? Count::bad_messages : Count::refused);
  if (++refusals_logged_ <= kMaxRefusalsLogged) {
    options_.log(
        LogLevel::warning,
        "refused " + os::to_text(connection.peer()) + ": " + reason +
            (refusals_logged_ == kMaxRefusalsLogged ? " (further refusals are only counted)" : ""));
  }
  send(connection, wire::Refusal{code, reason});
  if (connection.client != 0) release(connection);
  connection.close_softly(os::monotonic_us() + kClosingUs);
}

void ControlServer::reject(ControlConnection& connection, const std::string& reason) {
  refuse(connection, wire::Refusal::Code::bad_message, reason);
}

void ControlServer::drop(ControlConnection& connection, const std::string& why) {
  options_.log(LogLevel::warning, connection.name + " at " + os::to_text(connection.peer()) +
                                      " is dropped: it " + why);
  release(connection);
}

// The client is no longer one; its team is free.
void ControlServer::release(ControlConnection& connection) {
  connection.state = State::dead;
  if (connection.client == 0) return;
  if (connection.team < foosball::kTeams) team_owner_[connection.team] = 0;
  ControlEvent event;
  event.kind = ControlEvent::Kind::left;
  event.client = connection.client;
  leavers_.push_back(event);
  tell_leavers();
  count(Count::left);
  options_.log(LogLevel::info, connection.name + " at " + os::to_text(connection.peer()) + " left");
  connection.client = 0;
}

void ControlServer::expire(ControlConnection& connection) {
  const bool waits = connection.state == State::greeting || connection.state == State::closing;
  if (!waits || os::monotonic_us() < connection.deadline_us) return;
  if (connection.state == State::greeting) count(Count::timed_out);
  release(connection);
}

// --- between the threads
// --------------------------------------------------------------------------

void ControlServer::publish_notices() {
  wire::Notice notice;
  while (outbound_.pop(notice)) {
    const bool cleared = notice.level == wire::Notice::Level::cleared;
    options_.log(cleared ? LogLevel::info : LogLevel::warning, notice.text);
    for (auto& connection : connections_) {
      if (connection->state == State::joined) send(*connection, notice);
    }
    if (cleared) {
      notices_.erase(notice.topic);
    } else {
      notices_[notice.topic] = notice;
    }
  }
}

void ControlServer::tell_leavers() {
  std::size_t told = 0;
  while (told < leavers_.size() && events_.push(leavers_[told])) ++told;
  leavers_.erase(leavers_.begin(), leavers_.begin() + static_cast<std::ptrdiff_t>(told));
}

void ControlServer::say_goodbye() {
  publish_notices();
  for (auto& connection : connections_) {
    if (connection->state == State::joined) send(*connection, wire::Bye{bye_reason_});
    if (connection->state == State::joined) {
      connection->close_softly(0);
    }
  }
  const std::int64_t until = os::monotonic_us() + kGoodbyeUs;
  const auto unsent = [](const auto& c) { return c->flush() && c->wants_to_send(); };
  while (std::any_of(connections_.begin(), connections_.end(), unsent) &&
         os::monotonic_us() < until) {
    ::poll(nullptr, 0, 1);
  }
}

}  // namespace server
