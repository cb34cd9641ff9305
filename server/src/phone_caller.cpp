#include "phone_caller.h"

#include <sys/socket.h>

#include <algorithm>

#include "os/clock.h"
#include "phone_page.h"

namespace server {
namespace {

constexpr std::size_t kMaxHead = 4096;               // bytes of a request's head
constexpr std::size_t kMaxToControl = 64 * 1024;     // pending bytes
constexpr auto kFarewell = std::chrono::seconds(1);  // time to read the reason before the end
constexpr std::string_view kScanAgain = "Scan the code on the game's screen again.\n";
constexpr std::string_view kNoRoom = "Too many phones are connected: try again later.\n";

// Constant time for every wrong token.
bool same_secret(std::string_view a, std::string_view b) {
  if (a.size() != b.size()) return false;
  unsigned differs = 0;
  for (std::size_t i = 0; i < a.size(); ++i)
    differs |= static_cast<unsigned char>(a[i]) ^ static_cast<unsigned char>(b[i]);
  return differs == 0;
}

int family_of(const os::SocketAddress& address) {
  return address.is_ipv6() ? AF_INET6 : AF_INET;
}

}  // namespace

PhoneCaller::PhoneCaller(PhoneHouse& house, asio::io_context& io, os::FileDescriptor socket,
                         const os::SocketAddress& peer)
    : house_(house),
      peer_(peer),
      socket_(io.get_executor()),
      deadline_(io),
      pace_(io),
      buffer_(2 * kMaxHead),
      guest_(house.options().layout),
      pace_limit_(house.options().limits.messages_at_once, house.options().limits.message_every_us),
      link_(io) {
  auto& stream = beast::get_lowest_layer(socket_);
  Error error;
  const int fd = socket.release();
  stream.socket().assign(family_of(peer) == AF_INET6 ? asio::ip::tcp::v6() : asio::ip::tcp::v4(),
                         fd, error);
  if (error) {
    ::close(fd);
    dead_ = true;
    return;
  }
  stream.socket().set_option(asio::ip::tcp::no_delay(true), error);
  stream.rate_policy().read_limit(house.options().limits.bytes_per_second);
}

void PhoneCaller::begin() {
  if (dead_) return house_.gone(this);
  deadline_.expires_after(std::chrono::microseconds(house_.options().limits.hello_us));
  deadline_.async_wait([self = shared_from_this()](const Error& cancelled) {
    if (cancelled || self->dead_) return;
    if (!self->closing_) self->house_.count(Count::timed_out);
    self->drop();
  });
  read_request();
}

void PhoneCaller::drop() {
  if (dead_) return;
  const auto self = shared_from_this();
  dead_ = true;
  Error ignored;
  deadline_.cancel();
  pace_.cancel();
  beast::get_lowest_layer(socket_).socket().close(ignored);
  link_.close(ignored);
  house_.gone(this);
}

void PhoneCaller::leave_after_output() {
  if (!inside_) return drop();
  end_after_output_ = true;
  if (to_phone_.empty()) drop();
}

// --- HTTP

void PhoneCaller::read_request() {
  parser_.emplace();
  parser_->header_limit(kMaxHead);
  parser_->body_limit(0);
  http::async_read(beast::get_lowest_layer(socket_), buffer_, *parser_,
                   [self = shared_from_this()](const Error& error, std::size_t bytes) {
                     if (self->dead_) return;
                     if (!error) return self->answer(self->parser_->get(), bytes);
                     if (error != http::error::end_of_stream && error != asio::error::eof)
                       self->house_.count(Count::bad_messages);
                     self->drop();
                   });
}

PhoneCaller::Target PhoneCaller::target_of(std::string_view path) const {
  constexpr std::string_view kSocket = "/ws";
  const std::size_t size = house_.token().size();
  if (!path.starts_with('/') || !same_secret(path.substr(1, size), house_.token()))
    return Target::none;
  const std::string_view rest = path.substr(1 + size);
  if (rest == kSocket) return Target::socket;
  return rest.empty() || rest == "/" ? Target::page : Target::none;
}

void PhoneCaller::answer(const Request& request, std::size_t bytes) {
  const auto path = request.target();
  const Target target = target_of({path.data(), path.size()});
  const bool gets = request.method() == http::verb::get;
  if (target == Target::none || !gets) {
    house_.count(Count::refused);
    return send_sentence("404 Not Found", kScanAgain, bytes);
  }
  if (target == Target::page) return send_page();
  if (!websocket::is_upgrade(request)) {
    house_.count(Count::bad_messages);
    return send_sentence("400 Bad Request", kScanAgain, bytes);
  }
  if (!house_.has_room()) {
    house_.count(Count::refused);
    return send_sentence("503 Service Unavailable", kNoRoom, kMaxHead);
  }
  open_socket(request);
}

// The page must not be cached or framed by another page; it loads nothing.
void PhoneCaller::send_page() {
  house_.count(Count::pages);
  const std::string_view page = phone_page();
  std::string bytes =
      "HTTP/1.1 200 OK\r\n"
      "Content-Type: text/html; charset=utf-8\r\n"
      "Cache-Control: no-store\r\n"
      "Referrer-Policy: no-referrer\r\n"
      "X-Content-Type-Options: nosniff\r\n"
      "X-Frame-Options: DENY\r\n"
      "Content-Security-Policy: default-src 'none'; script-src 'unsafe-inline'; "
      "style-src 'unsafe-inline'; img-src data:; connect-src ws: wss:\r\n"
      "Connection: close\r\n"
      "Content-Length: " +
      std::to_string(page.size()) + "\r\n\r\n";
  bytes += page;
  send_and_close(std::move(bytes));
}

// most: max size of the answer [bytes]; a larger answer is not sent.
void PhoneCaller::send_sentence(std::string_view status, std::string_view sentence,
                                std::size_t max) {
  std::string bytes =
      "HTTP/1.1 " + std::string(status) +
      "\r\nConnection: close\r\nContent-Length: " + std::to_string(sentence.size()) + "\r\n\r\n" +
      std::string(sentence);
  if (bytes.size() > max) return drop();
  send_and_close(std::move(bytes));
}

void PhoneCaller::send_and_close(std::string&& bytes) {
  reply_ = std::move(bytes);
  asio::async_write(beast::get_lowest_layer(socket_), asio::buffer(reply_),
                    [self = shared_from_this()](const Error& error, std::size_t) {
                      if (self->dead_) return;
                      if (error) return self->drop();
                      Error ignored;
                      beast::get_lowest_layer(self->socket_)
                          .socket()
                          .shutdown(asio::ip::tcp::socket::shutdown_send, ignored);
                      self->closing_ = true;
                      self->deadline_.expires_after(kFarewell);
                      self->deadline_.async_wait([self](const Error& cancelled) {
                        if (!cancelled) self->drop();
                      });
                      self->read_out();
                    });
}

// Closing with unread data would reset the connection, and the peer could lose the answer.
void PhoneCaller::read_out() {
  buffer_.clear();
  beast::get_lowest_layer(socket_).async_read_some(
      buffer_.prepare(1024), [self = shared_from_this()](const Error& error, std::size_t) {
        if (self->dead_) return;
        error ? self->drop() : self->read_out();
      });
}

// --- WebSocket

void PhoneCaller::open_socket(const Request& request) {
  upgrade_ = request;
  buffer_.clear();
  const auto& limits = house_.options().limits;
  websocket::stream_base::timeout timeout{};
  timeout.handshake_timeout = std::chrono::microseconds(limits.hello_us);
  timeout.idle_timeout = std::chrono::microseconds(limits.silent_us);
  timeout.keep_alive_pings = true;
  socket_.set_option(timeout);
  socket_.read_message_max(wire::kMaxPhoneRequest);
  socket_.async_accept(upgrade_, [self = shared_from_this()](const Error& error) {
    if (self->dead_) return;
    if (error) {
      self->house_.count(Count::bad_messages);
      return self->drop();
    }
    self->socket_.binary(true);
    self->open_ = true;
    self->read_message();
  });
}

void PhoneCaller::read_message() {
  socket_.async_read(buffer_, [self = shared_from_this()](const Error& error, std::size_t) {
    if (self->dead_) return;
    if (!error) return self->take_message();
    const bool left = error == websocket::error::closed;
    // A deliberate close frees the seat.
    if (left && self->socket_.reason().code == websocket::close_code::normal && self->link_open_) {
      self->says_bye_ = true;
      wire::encode_control(wire::Bye{"the page was closed"}, self->link_out_);
      return self->write_link();
    }
    if (!left && error != asio::error::operation_aborted && error != asio::error::eof &&
        error != asio::error::connection_reset && error != beast::error::timeout)
      self->house_.count(Count::bad_messages);
    self->drop();
  });
}

// Reads one message at a time, within the rate limit; the others wait in the kernel.
void PhoneCaller::take_message() {
  if (closing_) return;
  if (!pace_limit_.take(os::monotonic_us())) {
    pace_.expires_after(std::chrono::microseconds(10 * house_.options().limits.message_every_us));
    pace_.async_wait([self = shared_from_this()](const Error& cancelled) {
      if (!cancelled && !self->dead_) self->take_message();
    });
    return;
  }
  const auto data = buffer_.cdata();
  const std::span<const std::byte> bytes(static_cast<const std::byte*>(data.data()), data.size());
  const bool good = socket_.got_binary() && wire::decode_phone(bytes, message_);
  buffer_.clear();
  if (!good) {
    house_.count(Count::bad_messages);
    return close_socket(websocket::close_code::bad_payload);
  }
  follow(guest_.handle(message_));
  if (!dead_ && !closing_) read_message();
}

void PhoneCaller::follow(PhoneGuest::Outcome&& outcome) {
  if (turned_away_) return;
  if (guest_.greeted() && !inside_) {
    // Others may have joined since the upgrade. A rejected phone takes no slot.
    const bool room = house_.has_room();
    inside_ = room;
    turned_away_ = !room;
    deadline_.cancel();
    if (!room) house_.count(Count::refused);
    if (!room || !open_link()) {
      send(wire::PhoneNotice{number(wire::PhoneNotice::Level::end),
                             (room ? wire::make_sentence<wire::SentenceId::server_overloaded>()
                                   : wire::make_sentence<wire::SentenceId::server_full>())
                                 .text()});
      outcome.end = true;
      outcome.to_control.clear();
    }
  }
  if (dead_) return;
  for (const auto& message : outcome.to_control) wire::encode_control(message, link_out_);
  if (outcome.input) house_.take(*outcome.input);
  for (const auto& reply : outcome.to_phone) send(reply);
  if (dead_) return;
  if (link_out_.size() > kMaxToControl) return drop();
  write_link();
  if (!outcome.end) return;
  end_after_output_ = true;
  if (to_phone_.empty()) close_socket(websocket::close_code::normal);
}

void PhoneCaller::send(const wire::PhoneReply& reply) {
  if (dead_ || closing_ || !open_) return;
  if (to_phone_.size() >= house_.options().limits.unsent) {
    house_.count(Count::slow_dropped);
    return drop();
  }
  std::vector<std::byte> bytes(wire::kMaxPhoneReply);
  bytes.resize(wire::encode_phone(reply, bytes));
  to_phone_.push_back(std::move(bytes));
  if (to_phone_.size() == 1) write_next();
}

void PhoneCaller::write_next() {
  const auto& bytes = to_phone_.front();
  socket_.async_write(asio::buffer(bytes.data(), bytes.size()),
                      [self = shared_from_this()](const Error& error, std::size_t) {
                        if (self->dead_) return;
                        if (error) return self->drop();
                        self->to_phone_.pop_front();
                        if (!self->to_phone_.empty()) return self->write_next();
                        if (self->end_after_output_)
                          self->close_socket(websocket::close_code::normal);
                      });
}

// Gives the peer a moment to answer the close.
void PhoneCaller::close_socket(websocket::close_code code) {
  if (closing_ || dead_) return;
  closing_ = true;
  Error ignored;
  link_.close(ignored);
  deadline_.expires_after(kFarewell);
  deadline_.async_wait([self = shared_from_this()](const Error& cancelled) {
    if (!cancelled) self->drop();
  });
  socket_.async_close(code, [self = shared_from_this()](const Error&) { self->drop(); });
}

void PhoneCaller::pulse(const PhonePulseEvent& event) {
  const auto rod = guest_.index_of(event.rod);
  if (!rod || !inside_) return;
  house_.count(Count::pulses);
  send(wire::PhonePulse{*rod, event.strength, event.ms});
}

// --- the control port

bool PhoneCaller::open_link() {
  int ends[2] = {-1, -1};
  if (::socketpair(AF_UNIX, SOCK_STREAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0, ends) != 0) return false;
  os::FileDescriptor mine(ends[0]), other(ends[1]);
  Error error;
  link_.assign(asio::local::stream_protocol(), mine.get(), error);
  if (error) return false;
  mine.release();
  const auto local = os::local_address(beast::get_lowest_layer(socket_).socket().native_handle());
  if (!house_.adopt({std::move(other), peer_, local})) return false;
  link_open_ = true;
  house_.count(Count::joined);
  house_.log(LogLevel::info, "a phone at " + os::to_text(peer_) + " has the token");
  read_link();
  return true;
}

void PhoneCaller::read_link() {
  link_.async_read_some(
      asio::buffer(link_in_.data(), link_in_.size()),
      [self = shared_from_this()](const Error& error, std::size_t size) {
        if (self->dead_ || self->closing_) return;
        if (error) {
          // Another connection took its seat, or the server ends.
          self->end_after_output_ = true;
          if (self->to_phone_.empty()) self->close_socket(websocket::close_code::going_away);
          return;
        }
        self->reader_.push(std::span<const std::byte>(self->link_in_).first(size));
        wire::ControlMessage message;
        while (!self->dead_ && !self->closing_ &&
               self->reader_.next(message) == wire::ControlReader::Status::message)
          self->follow(self->guest_.handle(message));
        if (!self->dead_ && !self->closing_) self->read_link();
      });
}

void PhoneCaller::write_link() {
  if (!link_open_ || link_out_.empty() || !link_writing_.empty()) return;
  link_writing_.swap(link_out_);
  asio::async_write(link_, asio::buffer(link_writing_.data(), link_writing_.size()),
                    [self = shared_from_this()](const Error& error, std::size_t) {
                      if (self->dead_) return;
                      self->link_writing_.clear();
                      if (error || (self->says_bye_ && self->link_out_.empty()))
                        return self->drop();
                      self->write_link();
                    });
}

}  // namespace server
