#include "core/control_link.h"

#include <poll.h>
#include <sys/socket.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>

#include "os/clock.h"
#include "os/socket_address.h"

namespace client {
namespace {

constexpr std::int64_t kAskRefusedAgainUs =
    2'000'000;  // whoever refused will hardly change its mind at once
constexpr std::int64_t kListenEveryUs = 50'000;  // how soon a silence is noticed
constexpr std::size_t kMostNotices = 64;         // a stranger's topics must not fill the memory
constexpr std::size_t kMostQueued = 256 * 1024;  // bytes that a server may leave unread

}  // namespace

ControlLink::ControlLink(const ConnectionOptions& options, const sockaddr_in& server,
                         SnapshotListener& listener)
    : options_(options), server_(server), listener_(listener) {}

ControlLink::~ControlLink() {
  stop_ = true;
  waker_.wake();
  if (thread_.joinable()) thread_.join();
}

ConnectionStatus ControlLink::status() const {
  const std::lock_guard lock(mutex_);
  return status_;
}

std::vector<wire::Notice> ControlLink::notices() const {
  const std::lock_guard lock(mutex_);
  std::vector<wire::Notice> standing;
  for (const auto& [topic, notice] : notices_) standing.push_back(notice);
  return standing;
}

void ControlLink::wish(std::uint64_t session, const wire::Wish& wish) {
  const std::lock_guard lock(mutex_);
  if (status_.link != Link::joined || status_.welcome.session != session) return;
  wishes_.push_back(wish);
  waker_.wake();
}

void ControlLink::run() {
  while (!stop_) {
    on_time(os::monotonic_us());
    const short events = static_cast<short>(
        stage_ == Stage::connecting || !out_.empty() ? POLLIN | POLLOUT : POLLIN);
    pollfd polled[2] = {{waker_.fd(), POLLIN, 0},
                        {stage_ == Stage::idle ? -1 : tcp_.get(), events, 0}};
    if (::poll(polled, 2, wait_ms(os::monotonic_us())) < 0) continue;
    if (polled[0].revents != 0) waker_.drain();
    const std::int64_t now = os::monotonic_us();
    if (stage_ == Stage::connecting && polled[1].revents != 0) {
      on_connected(now);
    } else if (stage_ != Stage::idle && polled[1].revents != 0) {
      if ((polled[1].revents & POLLOUT) != 0) flush(now);
      if ((polled[1].revents & ~POLLOUT) != 0 && stage_ != Stage::idle) on_readable(now);
    }
  }
  say_bye();
}

int ControlLink::wait_ms(std::int64_t now_us) const {
  std::int64_t until = next_try_us_;
  if (stage_ == Stage::joined) until = now_us + kListenEveryUs;
  if (stage_ == Stage::connecting || stage_ == Stage::greeting) until = deadline_us_;
  return static_cast<int>(std::clamp<std::int64_t>((until - now_us + 999) / 1000, 0, 1000));
}

void ControlLink::on_time(std::int64_t now_us) {
  if (stage_ == Stage::idle && now_us >= next_try_us_) begin(now_us);
  if ((stage_ == Stage::connecting || stage_ == Stage::greeting) && now_us >= deadline_us_) {
    drop("it does not answer", now_us);
  }
  if (stage_ != Stage::joined) return;
  std::vector<wire::Wish> wishes;
  {
    const std::lock_guard lock(mutex_);
    wishes.swap(wishes_);
  }
  for (const wire::Wish& wish : wishes) queue(wish);
  if (!wishes.empty()) flush(now_us);
  if (now_us - std::max(joined_at_us_, listener_.last_arrival_us()) > options_.silence_us) {
    drop("no snapshot for " + std::to_string(options_.silence_us / 1000) + " ms", now_us);
  }
}

void ControlLink::begin(std::int64_t now_us) {
  next_try_us_ = now_us + options_.retry_us;
  auto tcp = begin_connect(server_);
  if (!tcp) return drop(tcp.error(), now_us);
  tcp_ = std::move(*tcp);
  stage_ = Stage::connecting;
  deadline_us_ = now_us + options_.patience_us;
}

void ControlLink::on_connected(std::int64_t now_us) {
  if (const int error = connect_result(tcp_.get()); error != 0)
    return drop(std::strerror(error), now_us);
  stage_ = Stage::greeting;
  reader_ = {};
  out_.clear();
  wire::Hello hello;
  hello.snapshot_layout = wire::snapshot_layout_hash();
  hello.name = options_.name;
  hello.udp_port = listener_.port();
  hello.team = options_.team;
  queue(hello);
  flush(now_us);
}

void ControlLink::on_readable(std::int64_t now_us) {
  std::array<std::byte, 4096> bytes;
  const auto size = ::recv(tcp_.get(), bytes.data(), bytes.size(), 0);
  if (size < 0 && (errno == EAGAIN || errno == EINTR)) return;
  if (size <= 0) return drop(size == 0 ? "it closed the connection" : std::strerror(errno), now_us);
  reader_.push({bytes.data(), static_cast<std::size_t>(size)});
  wire::ControlMessage message;
  for (;;) {
    const auto status = reader_.next(message);
    if (status == wire::ControlReader::Status::need_more) break;
    if (status == wire::ControlReader::Status::broken)
      return drop("it sends what is no message", now_us);
    if (!handle(message, now_us)) return;
  }
  flush(now_us);
}

// False: the connection is no more.
bool ControlLink::handle(const wire::ControlMessage& message, std::int64_t now_us) {
  if (const auto* welcome = std::get_if<wire::Welcome>(&message)) {
    if (stage_ == Stage::greeting) on_welcome(*welcome, now_us);
    return stage_ == Stage::joined;
  }
  if (const auto* refusal = std::get_if<wire::Refusal>(&message)) {
    drop(refusal->reason, now_us, true);
    return false;
  }
  if (const auto* bye = std::get_if<wire::Bye>(&message)) {
    drop(bye->reason.empty() ? "it said good-bye" : bye->reason, now_us);
    const std::lock_guard lock(mutex_);
    status_.server_ended = true;
    return false;
  }
  if (const auto* ping = std::get_if<wire::Ping>(&message)) queue(wire::Pong{ping->id});
  if (const auto* notice = std::get_if<wire::Notice>(&message)) on_notice(*notice);
  return true;
}

void ControlLink::on_welcome(const wire::Welcome& welcome, std::int64_t now_us) {
  const auto heard =
      listener_.join(welcome, server_, os::local_address(tcp_.get()).sin_addr.s_addr);
  if (!heard) return drop(heard.error(), now_us, true);
  stage_ = Stage::joined;
  joined_at_us_ = now_us;
  const std::lock_guard lock(mutex_);
  status_.link = Link::joined;
  status_.server_ended = false;
  status_.detail.clear();
  status_.welcome = welcome;
  ++status_.joins;
}

void ControlLink::on_notice(const wire::Notice& notice) {
  const std::lock_guard lock(mutex_);
  if (notice.level == wire::Notice::Level::cleared) {
    notices_.erase(notice.topic);
  } else if (notices_.size() < kMostNotices || notices_.contains(notice.topic)) {
    notices_[notice.topic] = notice;
  }
}

void ControlLink::drop(const std::string& why, std::int64_t now_us, bool refused) {
  listener_.leave();
  tcp_ = {};
  stage_ = Stage::idle;
  next_try_us_ =
      std::max(next_try_us_, now_us + (refused ? kAskRefusedAgainUs : options_.retry_us));
  const std::lock_guard lock(mutex_);
  wishes_.clear();
  notices_.clear();  // of a server that may be another when it is back
  status_.detail = why;
  status_.link = refused ? Link::refused : status_.joins > 0 ? Link::lost : Link::connecting;
}

void ControlLink::queue(const wire::ControlMessage& message) {
  wire::encode_control(message, out_);
}

void ControlLink::flush(std::int64_t now_us) {
  while (!out_.empty()) {
    const auto sent = ::send(tcp_.get(), out_.data(), out_.size(), MSG_NOSIGNAL);
    if (sent < 0 && (errno == EAGAIN || errno == EINTR)) break;
    if (sent < 0) return drop(std::strerror(errno), now_us);
    out_.erase(out_.begin(), out_.begin() + sent);
  }
  if (out_.size() > kMostQueued) drop("it does not read what it is sent", now_us);
}

void ControlLink::say_bye() {
  if (stage_ != Stage::joined && stage_ != Stage::greeting) return;
  queue(wire::Bye{"the window was closed"});
  [[maybe_unused]] const auto sent = ::send(tcp_.get(), out_.data(), out_.size(), MSG_NOSIGNAL);
}

}  // namespace client
