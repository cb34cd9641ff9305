#include "listeners.h"

#include <poll.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <vector>

#include "probe_client.h"

namespace bench {
namespace {

struct Listener {
  server::ProbeClient client;
  std::uint64_t session = 0;
  std::uint64_t last_sequence = 0;  // 0: none yet
  bool over = false;
};

void take(Listener& listener, ListenerTotals& totals) {
  const auto snapshot = listener.client.snapshot(0);
  if (!snapshot || snapshot->session != listener.session) {
    ++totals.bad;
    return;
  }
  ++totals.received;
  if (listener.last_sequence != 0 && snapshot->sequence <= listener.last_sequence) {
    ++totals.reordered;
    return;
  }
  if (listener.last_sequence != 0) totals.gaps += snapshot->sequence - listener.last_sequence - 1;
  listener.last_sequence = snapshot->sequence;
}

void drain(Listener& listener, ListenerTotals& totals) {
  while (server::wait_readable(listener.client.udp(), 0)) take(listener, totals);
}

bool is_closed(int tcp) {
  std::byte next{};
  return ::recv(tcp, &next, 1, MSG_PEEK | MSG_DONTWAIT) == 0;
}

// Whether the server has said Bye or closed. Nothing to receive does not mean that: a client
// discards some messages.
bool has_ended(Listener& listener) {
  while (const auto message = listener.client.receive(0)) {
    if (std::holds_alternative<wire::Bye>(*message)) return true;
  }
  return is_closed(listener.client.tcp());
}

// One poll over all sockets, on one thread; ends when each connection has ended.
void listen(std::vector<Listener>& listeners, ListenerTotals& totals) {
  std::size_t open = listeners.size();
  std::vector<pollfd> polled;
  for (Listener& l : listeners) {
    polled.push_back({l.client.udp(), POLLIN, 0});
    polled.push_back({l.client.tcp(), POLLIN, 0});
  }
  while (open > 0 && ::poll(polled.data(), polled.size(), -1) > 0) {
    for (std::size_t i = 0; i < listeners.size(); ++i) {
      Listener& l = listeners[i];
      if (polled[2 * i].revents != 0) drain(l, totals);
      if (polled[2 * i + 1].revents == 0 || l.over) continue;
      if (!has_ended(l)) continue;
      drain(l, totals);  // everything was sent before the Bye
      l.over = true;
      polled[2 * i + 1].fd = -1;
      --open;
    }
  }
  totals.complete = open == 0;
}

[[noreturn]] void live_as_child(int count, int from_parent, int to_parent) {
  std::uint16_t port = 0;
  ListenerTotals totals;
  if (::read(from_parent, &port, sizeof port) != sizeof port) ::_exit(1);
  std::vector<Listener> listeners;
  for (int i = 0; i < count; ++i) {
    Listener listener{.client = server::ProbeClient(port)};
    const auto welcome = listener.client.join();
    if (!welcome) continue;
    listener.session = welcome->session;
    listeners.push_back(std::move(listener));
  }
  totals.joined = listeners.size();
  bool told = ::write(to_parent, &totals, sizeof totals) == sizeof totals;
  listen(listeners, totals);
  told = told && ::write(to_parent, &totals, sizeof totals) == sizeof totals;
  ::_exit(told ? 0 : 1);
}

std::optional<ListenerTotals> read_totals(int fd) {
  ListenerTotals totals;
  const bool whole = ::read(fd, &totals, sizeof totals) == static_cast<ssize_t>(sizeof totals);
  return whole ? std::optional(totals) : std::nullopt;
}

}  // namespace

Listeners::Listeners(int count) {
  std::array<int, 2> down{-1, -1}, up{-1, -1};
  if (::pipe(down.data()) != 0 || ::pipe(up.data()) != 0) return;
  child_ = ::fork();
  if (child_ == 0) {
    ::close(down[1]);
    ::close(up[0]);
    live_as_child(count, down[0], up[1]);
  }
  ::close(down[0]);
  ::close(up[1]);
  to_child_ = down[1];
  from_child_ = up[0];
  expected_ = static_cast<std::uint64_t>(count);
}

Listeners::~Listeners() {
  if (to_child_ >= 0) ::close(to_child_);
  if (from_child_ >= 0) ::close(from_child_);
  if (child_ > 0) ::waitpid(child_, nullptr, 0);
}

bool Listeners::join(std::uint16_t port) {
  if (child_ <= 0 || ::write(to_child_, &port, sizeof port) != sizeof port) return false;
  const auto joined = read_totals(from_child_);
  return joined && joined->joined == expected_;
}

std::optional<ListenerTotals> Listeners::totals() {
  return read_totals(from_child_);
}

}  // namespace bench
