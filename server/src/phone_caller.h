// One TCP connection on the port for phones. It begins with an HTTP request, which is answered with
// the page, with a sentence, or with a WebSocket; the phone's messages follow. Everything runs on
// the port's thread. Boost.Beast reads the untrusted bytes under limits; nothing here asserts.
//
// A connection has 5 s to become a phone that has sent a hello. The time counts from the
// connection, so that slow senders hold no slot. Bytes per second, messages per second and message
// length are limited. Without the token, a reply is never longer than the request.
#pragma once

#include <array>
#include <utility>  // Asio of Boost 1.74 lacks it
// clang-format off
#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/local/stream_protocol.hpp>
#include <boost/asio/posix/stream_descriptor.hpp>
#include <boost/asio/post.hpp>
#include <boost/asio/steady_timer.hpp>
#include <boost/asio/write.hpp>
// clang-format on
#include <boost/beast/core.hpp>
#include <boost/beast/http.hpp>
#include <boost/beast/websocket.hpp>
#include <deque>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "door.h"
#include "phone_port.h"

namespace server {

namespace asio = boost::asio;
namespace beast = boost::beast;
namespace http = beast::http;
namespace websocket = beast::websocket;
using Error = boost::system::error_code;

class PhoneCaller;

// The interface of the port to its callers.
class PhoneHouse {
 public:
  enum class Count : std::size_t {
    accepted,
    pages,
    joined,
    refused,
    bad_messages,
    timed_out,
    crowded_out,
    slow_dropped,
    inputs,
    inputs_dropped,
    pulses,
    pulses_dropped,
    kCount
  };
  virtual ~PhoneHouse() = default;
  virtual const PhonePortOptions& options() const = 0;
  virtual const std::string& token() const = 0;
  virtual bool has_room() const = 0;  // for one more phone
  virtual bool adopt(VouchedConnection&& connection) = 0;
  virtual void take(const PhoneInputEvent& event) = 0;
  virtual void count(Count which) = 0;
  virtual void log(LogLevel level, const std::string& text) = 0;
  virtual void gone(PhoneCaller* caller) = 0;  // may be destroyed now
};

class PhoneCaller final : public std::enable_shared_from_this<PhoneCaller> {
 public:
  using Stream =
      beast::basic_stream<asio::ip::tcp, asio::any_io_executor, beast::simple_rate_policy>;

  PhoneCaller(PhoneHouse& house, asio::io_context& io, os::FileDescriptor socket,
              const os::SocketAddress& peer);

  void begin();
  void drop();                // immediately
  void leave_after_output();  // the server ends: after pending output, if there is any
  bool inside() const { return inside_; }
  const os::SocketAddress& peer() const { return peer_; }
  std::uint32_t client() const { return guest_.client(); }
  void pulse(const PhonePulseEvent& event);

 private:
  using Count = PhoneHouse::Count;
  using Request = http::request<http::empty_body>;
  enum class Target : std::uint8_t { none, page, socket };

  void read_request();
  void answer(const Request& request, std::size_t bytes);
  Target target_of(std::string_view path) const;
  void send_page();
  void send_sentence(std::string_view status, std::string_view sentence, std::size_t max);
  void send_and_close(std::string&& bytes);
  void read_out();
  void open_socket(const Request& request);
  void read_message();
  void take_message();
  void follow(PhoneGuest::Outcome&& outcome);
  bool open_link();
  void read_link();
  void write_link();
  void send(const wire::PhoneReply& reply);
  void write_next();
  void close_socket(websocket::close_code code);

  PhoneHouse& house_;
  os::SocketAddress peer_;
  websocket::stream<Stream> socket_;
  asio::steady_timer deadline_, pace_;
  bool inside_ = false, dead_ = false, closing_ = false, open_ = false;

  beast::flat_buffer buffer_;
  std::optional<http::request_parser<http::empty_body>> parser_;
  std::string reply_;
  Request upgrade_;

  PhoneGuest guest_;
  RateLimit pace_limit_;
  wire::PhoneRequest message_;
  std::deque<std::vector<std::byte>> to_phone_;  // the first is being written

  asio::local::stream_protocol::socket link_;
  std::array<std::byte, 16 * 1024> link_in_;
  wire::ControlReader reader_;
  std::vector<std::byte> link_out_, link_writing_;
  bool link_open_ = false, end_after_output_ = false, says_bye_ = false, turned_away_ = false;
};

}  // namespace server
