#include "core/control_link.h"

#include <poll.h>
#include <sys/socket.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <utility>

#include "characters/record.h"
#include "os/clock.h"
#include "wire/enums.h"

namespace client {
namespace {

constexpr std::int64_t kAskRefusedAgainUs = 2'000'000;  // a refusal rarely changes at once
constexpr std::int64_t kListenEveryUs = 50'000;         // how soon a silence is noticed
constexpr std::size_t kMaxNotices = 64;  // a malicious server's topics must not fill the memory
constexpr std::size_t kMaxQueued = 256 * 1024;  // bytes that a server may leave unread
// Time that the destructor waits until Bye is delivered: a lost one is retransmitted after 200 ms.
constexpr int kGoodbyeMs = 500;

}  // namespace

ControlLink::ControlLink(const ConnectionOptions& options, const os::SocketAddress& server,
                         SnapshotListener& listener)
    : options_(options), server_(server), listener_(listener), name_(options.name) {
  status_.characters =
      std::make_shared<const foosball::Characters>(foosball::built_in_characters());
}

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

wire::Roster ControlLink::roster() const {
  const std::lock_guard lock(mutex_);
  return roster_;
}

void ControlLink::ask(const wire::ControlMessage& message, std::uint64_t session) {
  const std::lock_guard lock(mutex_);
  if (status_.link != Link::joined || status_.welcome.session != session) return;
  asked_.push_back(message);
  waker_.wake();
}

void ControlLink::request(std::uint64_t session, const wire::MatchRequest& request) {
  ask(request, session);
}

void ControlLink::claim(std::uint64_t session, const wire::Claim& claim) {
  ask(claim, session);
}

void ControlLink::kick(std::uint64_t session, const wire::Kick& kick) {
  ask(kick, session);
}

void ControlLink::choose(std::uint64_t session, const wire::Game& game) {
  ask(game, session);
}

void ControlLink::join_as(const std::string& name) {
  const std::lock_guard lock(mutex_);
  name_ = name;
}

void ControlLink::name(std::uint64_t session, const wire::Names& names) {
  join_as(names.name);
  ask(names, session);
}

void ControlLink::answer(std::uint64_t session, const wire::Answers& answers) {
  ask(answers, session);
}

void ControlLink::ask_devices(std::uint64_t session) {
  ask(wire::DeviceQuery{}, session);
}

std::optional<wire::Devices> ControlLink::take_devices() {
  const std::lock_guard lock(mutex_);
  return std::exchange(devices_, std::nullopt);
}

std::optional<wire::Questionnaire> ControlLink::questionnaire() const {
  const std::lock_guard lock(mutex_);
  return questionnaire_;
}

std::optional<wire::Report> ControlLink::report() const {
  const std::lock_guard lock(mutex_);
  return report_;
}

std::string ControlLink::phones() const {
  const std::lock_guard lock(mutex_);
  return status_.link == Link::joined ? phones_ : std::string();
}

std::optional<wire::Tuning> ControlLink::tuning() const {
  const std::lock_guard lock(mutex_);
  return tuning_;
}

std::optional<wire::Game> ControlLink::game() const {
  const std::lock_guard lock(mutex_);
  return game_;
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
  send_bye();
}

int ControlLink::wait_ms(std::int64_t now_us) const {
  std::int64_t until = next_try_us_;
  if (stage_ == Stage::joined) until = now_us + kListenEveryUs;
  if (stage_ != Stage::joined && stage_ != Stage::idle) until = deadline_us_;
  return static_cast<int>(std::clamp<std::int64_t>((until - now_us + 999) / 1000, 0, 1000));
}

void ControlLink::on_time(std::int64_t now_us) {
  if (stage_ == Stage::idle && now_us >= next_try_us_) begin(now_us);
  if (stage_ != Stage::joined && stage_ != Stage::idle && now_us >= deadline_us_) {
    drop("it does not answer", now_us);
  }
  if (stage_ != Stage::joined) return;
  std::vector<wire::ControlMessage> asked;
  {
    const std::lock_guard lock(mutex_);
    asked.swap(asked_);
  }
  for (const wire::ControlMessage& message : asked) queue(message);
  if (!asked.empty()) flush(now_us);
  if (stage_ == Stage::joined) watch_silence(now_us);
}

// Silence alone does not drop the connection, and with it the seat: the link may recover at any
// moment.
void ControlLink::watch_silence(std::int64_t now_us) {
  const std::int64_t silent = now_us - std::max(joined_at_us_, listener_.last_arrival_us());
  const std::string words =
      "no snapshot for " + std::to_string(std::min(silent, options_.silence_us) / 1000) + " ms";
  if (silent > options_.gone_us) return drop(words, now_us);
  const std::lock_guard lock(mutex_);
  status_.link = silent > options_.silence_us ? Link::lost : Link::joined;
  status_.detail = status_.link == Link::lost ? words : std::string();
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
  reader_ = {};
  out_.clear();
  sealer_.reset();
  opener_.reset();
  if (server_.is_loopback() && options_.trust_this_machine) {
    send_hello();
  } else {
    knock();
  }
  flush(now_us);
}

void ControlLink::knock() {
  wire::Knock knock;
  knock.role = number(options_.as_host ? wire::Role::host : wire::Role::player);
  knock.sid = wire::random_sid();
  exchange_ = std::make_unique<wire::PasswordExchange>(
      wire::PasswordExchange::Side::client, options_.password,
      wire::exchange_channel(options_.as_host), knock.sid);
  knock.share = exchange_->share();
  stage_ = Stage::proving;
  queue(knock);
}

// False: the connection was dropped.
bool ControlLink::on_challenge(const wire::Challenge& challenge, std::int64_t now_us) {
  const auto secret = exchange_->secret(challenge.share);
  exchange_.reset();
  if (!secret) {
    drop("it sends invalid messages", now_us);
    return false;
  }
  const wire::StreamKeys keys = wire::stream_keys(*secret);
  sealer_.emplace(keys.to_server);
  opener_.emplace(keys.to_client);
  reader_ = {};
  send_hello();
  return true;
}

void ControlLink::send_hello() {
  stage_ = Stage::greeting;
  wire::Hello hello;
  hello.snapshot_layout = wire::snapshot_layout_hash();
  hello.udp_port = listener_.port();
  hello.team = options_.team;
  hello.rods = options_.rods;
  {  // the seat held there before, if it is the same server
    const std::lock_guard lock(mutex_);
    hello.name = name_;
    hello.session = status_.welcome.session;
    hello.ticket = status_.joins > 0 ? status_.welcome.token : 0;
  }
  queue(hello);
}

void ControlLink::on_readable(std::int64_t now_us) {
  std::array<std::byte, 4096> bytes;
  const auto size = ::recv(tcp_.get(), bytes.data(), bytes.size(), 0);
  if (size < 0 && (errno == EAGAIN || errno == EINTR)) return;
  // A server that cannot open a message sealed with another password closes without an answer.
  const bool unproven = stage_ == Stage::greeting && sealer_;
  if (size <= 0 && unproven) {
    return drop("wrong password: give --password-file with the right one", now_us, true);
  }
  if (size <= 0) return drop(size == 0 ? "it closed the connection" : std::strerror(errno), now_us);
  if (take({bytes.data(), static_cast<std::size_t>(size)}, now_us)) flush(now_us);
}

// False: the connection was dropped.
bool ControlLink::take(std::span<const std::byte> bytes, std::int64_t now_us) {
  const auto nonsense = [&] {
    drop("it sends invalid messages", now_us);
    return false;
  };
  std::vector<std::byte> plain;
  if (opener_ && !opener_->open(bytes, plain)) return nonsense();
  reader_.push(opener_ ? std::span<const std::byte>(plain) : bytes);
  wire::ControlMessage message;
  for (;;) {
    const auto status = reader_.next(message);
    if (status == wire::ControlReader::Status::need_more) return true;
    if (status == wire::ControlReader::Status::broken) return nonsense();
    if (!handle(message, now_us)) return false;
  }
}

// False: the connection was dropped.
bool ControlLink::handle(const wire::ControlMessage& message, std::int64_t now_us) {
  // Before the server has proven that it knows the password, only messages of the proof are
  // accepted.
  const bool of_a_proof = std::holds_alternative<wire::Challenge>(message) ||
                          std::holds_alternative<wire::Refusal>(message);
  if (stage_ == Stage::proving && !of_a_proof) {
    drop("it sends invalid messages", now_us);
    return false;
  }
  if (const auto* welcome = std::get_if<wire::Welcome>(&message)) {
    if (stage_ == Stage::greeting) on_welcome(*welcome, now_us);
    return stage_ == Stage::joined;
  }
  if (const auto* challenge = std::get_if<wire::Challenge>(&message)) {
    return stage_ != Stage::proving || on_challenge(*challenge, now_us);
  }
  if (const auto* roster = std::get_if<wire::Roster>(&message)) {
    const std::lock_guard lock(mutex_);
    roster_ = *roster;
  }
  if (const auto* tuning = std::get_if<wire::Tuning>(&message)) {
    const std::lock_guard lock(mutex_);
    tuning_ = *tuning;
  }
  if (const auto* game = std::get_if<wire::Game>(&message)) {
    const std::lock_guard lock(mutex_);
    game_ = *game;
  }
  if (const auto* questionnaire = std::get_if<wire::Questionnaire>(&message)) {
    const std::lock_guard lock(mutex_);
    questionnaire_ = *questionnaire;
  }
  if (const auto* report = std::get_if<wire::Report>(&message)) {
    const std::lock_guard lock(mutex_);
    report_ = *report;
  }
  if (const auto* phones = std::get_if<wire::Phones>(&message)) {
    const std::lock_guard lock(mutex_);
    phones_ = phones->url;
  }
  if (const auto* devices = std::get_if<wire::Devices>(&message)) {
    const std::lock_guard lock(mutex_);
    devices_ = *devices;
  }
  if (const auto* record = std::get_if<wire::Characters>(&message)) {
    return on_characters(*record, now_us);
  }
  if (const auto* refusal = std::get_if<wire::Refusal>(&message)) {
    drop(refusal->reason, now_us, true);
    return false;
  }
  if (const auto* bye = std::get_if<wire::Bye>(&message)) {
    drop(bye->reason.empty() ? "it ended the session" : bye->reason, now_us);
    const std::lock_guard lock(mutex_);
    status_.server_ended = true;
    return false;
  }
  if (const auto* ping = std::get_if<wire::Ping>(&message)) queue(wire::Pong{ping->id});
  if (const auto* notice = std::get_if<wire::Notice>(&message)) on_notice(*notice);
  return true;
}

void ControlLink::on_welcome(const wire::Welcome& welcome, std::int64_t now_us) {
  const auto joined = listener_.join(welcome, server_, os::local_address(tcp_.get()));
  if (!joined) return drop(joined.error(), now_us, true);
  stage_ = Stage::joined;
  joined_at_us_ = now_us;
  const std::lock_guard lock(mutex_);
  phones_.clear();
  status_.link = Link::joined;
  status_.server_ended = false;
  status_.detail.clear();
  status_.welcome = welcome;
  ++status_.joins;
}

bool ControlLink::on_characters(const wire::Characters& record, std::int64_t now_us) {
  auto characters = characters::from_record(record);
  if (!characters) {
    drop("its characters cannot be played: use the same release of both", now_us);
    return false;
  }
  const std::lock_guard lock(mutex_);
  if (*characters != *status_.characters) {
    status_.characters = std::make_shared<const foosball::Characters>(std::move(*characters));
  }
  return true;
}

void ControlLink::on_notice(const wire::Notice& notice) {
  const std::lock_guard lock(mutex_);
  if (notice.level == wire::Notice::Level::cleared) {
    notices_.erase(notice.topic);
  } else if (notices_.size() < kMaxNotices || notices_.contains(notice.topic)) {
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
  asked_.clear();
  roster_ = {};
  tuning_.reset();
  game_.reset();
  questionnaire_.reset();
  report_.reset();
  devices_.reset();
  notices_.clear();  // the server may be another one when it is back
  status_.detail = why;
  status_.link = refused ? Link::refused : status_.joins > 0 ? Link::lost : Link::connecting;
}

void ControlLink::queue(const wire::ControlMessage& message) {
  if (!sealer_) return wire::encode_control(message, out_);
  std::vector<std::byte> plain;
  wire::encode_control(message, plain);
  sealer_->seal(plain, out_);
}

void ControlLink::flush(std::int64_t now_us) {
  while (!out_.empty()) {
    const auto sent = ::send(tcp_.get(), out_.data(), out_.size(), MSG_NOSIGNAL);
    if (sent < 0 && (errno == EAGAIN || errno == EINTR)) break;
    if (sent < 0) return drop(std::strerror(errno), now_us);
    out_.erase(out_.begin(), out_.begin() + sent);
  }
  if (out_.size() > kMaxQueued) drop("it does not read what is sent to it", now_us);
}

void ControlLink::send_bye() {
  if (stage_ != Stage::joined && stage_ != Stage::greeting) return;
  queue(wire::Bye{"the window was closed"});
  const std::int64_t until = os::monotonic_us() + std::int64_t{1000} * kGoodbyeMs;
  while (!out_.empty() && os::monotonic_us() < until) {
    const auto sent = ::send(tcp_.get(), out_.data(), out_.size(), MSG_NOSIGNAL);
    if (sent < 0 && errno != EAGAIN && errno != EINTR) return;
    if (sent > 0) out_.erase(out_.begin(), out_.begin() + sent);
    pollfd polled{tcp_.get(), POLLOUT, 0};
    if (!out_.empty()) ::poll(&polled, 1, 10);
  }
  os::finish_sending(tcp_.get(), static_cast<int>((until - os::monotonic_us()) / 1000));
}

}  // namespace client
