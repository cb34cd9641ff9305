// A minimal phone: its WebSocket. Every wait ends as soon as something arrives, or at a deadline.
#pragma once

#include <gtest/gtest.h>

#include <utility>
// clang-format off
#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/write.hpp>
// clang-format on
#include <boost/beast/core.hpp>
#include <boost/beast/websocket.hpp>
#include <chrono>
#include <deque>
#include <optional>
#include <string>
#include <vector>

#include "wire/enums.h"
#include "wire/phone_message.h"

namespace server {

class PhoneProbe {
 public:
  static constexpr auto kPatience = std::chrono::seconds(10);

  // url: http://HOST:PORT/TOKEN, as the server gives it.
  explicit PhoneProbe(const std::string& url) {
    const std::string rest = url.substr(std::string("http://").size());
    host_ = rest.substr(0, rest.find('/'));
    path_ = rest.substr(rest.find('/'));
    const auto colon = host_.rfind(':');
    boost::system::error_code error;
    const auto address = boost::asio::ip::make_address(host_.substr(0, colon), error);
    const auto port = static_cast<std::uint16_t>(std::stoi(host_.substr(colon + 1)));
    if (!error) socket_.next_layer().socket().connect({address, port}, error);
    connected_ = !error;
  }
  ~PhoneProbe() { vanish(); }
  PhoneProbe(const PhoneProbe&) = delete;
  PhoneProbe& operator=(const PhoneProbe&) = delete;

  bool connected() const { return connected_; }
  bool upgrade() { return upgrade(path_ + "/ws"); }
  bool upgrade(const std::string& target) {
    std::optional<bool> done;
    socket_.binary(true);
    socket_.async_handshake(host_, target, [&](const Error& error) { done = !error; });
    run([&] { return done.has_value(); });
    if (done.value_or(false)) read_next();
    return done.value_or(false);
  }
  // Upgrades, sends a hello, and returns the state in reply.
  std::optional<wire::PhoneState> join(const std::string& name = "Ann",
                                       const wire::PhoneState& before = {}) {
    if (!upgrade() || !send(wire::PhoneHello{before.session, before.ticket, name})) return {};
    return receive_a<wire::PhoneState>();
  }
  std::optional<wire::PhoneState> claim(int team, wire::RodPair pair) {
    if (!send(wire::PhoneClaim{static_cast<std::uint8_t>(team), number(pair)})) return {};
    return receive_a<wire::PhoneState>();
  }
  bool send(const wire::PhoneRequest& request) {
    std::vector<std::byte> bytes(wire::kMaxPhoneRequest);
    bytes.resize(wire::encode_phone(request, bytes));
    return send(bytes);
  }
  bool send(const std::vector<std::byte>& bytes, bool binary = true) {
    std::optional<bool> done;
    socket_.binary(binary);
    socket_.async_write(boost::asio::buffer(bytes),
                        [&](const Error& error, std::size_t) { done = !error; });
    run([&] { return done.has_value(); });
    return done.value_or(false);
  }
  // Below the WebSocket layer.
  bool send_raw(const std::vector<unsigned char>& bytes) {
    boost::system::error_code error;
    boost::asio::write(socket_.next_layer().socket(), boost::asio::buffer(bytes), error);
    return !error;
  }

  // The next message of this type; discards others. Nothing if none arrives or the line is closed.
  template <class Message>
  std::optional<Message> receive_a() {
    while (true) {
      run([&] { return !received_.empty() || closed_; });
      if (received_.empty()) return {};
      const wire::PhoneReply reply = std::move(received_.front());
      received_.pop_front();
      if (const auto* wanted = std::get_if<Message>(&reply)) return *wanted;
    }
  }
  template <class Message>
  bool has_heard_a() {
    io_.restart();
    io_.poll();
    for (const auto& reply : received_)
      if (std::holds_alternative<Message>(reply)) return true;
    return false;
  }
  bool sees_close() {
    run([&] { return closed_; });
    return closed_;
  }
  void send_goodbye() {  // like a page that is closed on purpose
    std::optional<bool> done;
    socket_.async_close(boost::beast::websocket::close_code::normal,
                        [&](const Error& error) { done = !error; });
    run([&] { return done.has_value(); });
  }
  void vanish() {
    boost::system::error_code ignored;
    socket_.next_layer().socket().close(ignored);
    io_.restart();
    io_.poll();
  }

 private:
  using Error = boost::system::error_code;

  template <class Done>
  void run(Done done) {
    const auto until = std::chrono::steady_clock::now() + kPatience;
    while (!done() && std::chrono::steady_clock::now() < until) {
      io_.restart();
      if (io_.run_one_until(until) == 0) return;
    }
  }
  void read_next() {
    socket_.async_read(buffer_, [this](const Error& error, std::size_t) {
      if (error) {
        closed_ = true;
        return;
      }
      const auto data = buffer_.cdata();
      wire::PhoneReply reply;
      const bool good = wire::decode_phone(
          std::span(static_cast<const std::byte*>(data.data()), data.size()), reply);
      EXPECT_TRUE(good) << "the server sent what is no message";
      if (good) received_.push_back(std::move(reply));
      buffer_.clear();
      read_next();
    });
  }

  boost::asio::io_context io_;
  boost::beast::websocket::stream<boost::beast::tcp_stream> socket_{io_};
  boost::beast::flat_buffer buffer_;
  std::string host_, path_;
  std::deque<wire::PhoneReply> received_;
  bool connected_ = false, closed_ = false;
};

}  // namespace server
