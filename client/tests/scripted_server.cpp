#include "scripted_server.h"

#include <poll.h>
#include <sys/socket.h>

#include <array>

#include "os/socket_address.h"

namespace client {
namespace {

std::uint16_t bind_to(int fd, std::uint16_t port) {
  const int on = 1;
  setsockopt(fd, SOL_SOCKET, SO_REUSEADDR, &on, sizeof on);
  const auto address = os::loopback(port);
  if (bind(fd, address.generic(), address.size()) != 0) return 0;
  return os::local_address(fd).port();
}

bool readable(const os::FileDescriptor& fd) {
  pollfd polled{fd.get(), POLLIN, 0};
  return fd && poll(&polled, 1, static_cast<int>(ScriptedServer::kPatience.count())) == 1;
}

}  // namespace

ScriptedServer::ScriptedServer(std::uint16_t port)
    : listener_(socket(AF_INET, SOCK_STREAM, 0)), udp_(socket(AF_INET, SOCK_DGRAM, 0)) {
  port_ = bind_to(listener_.get(), port);
  udp_port_ = bind_to(udp_.get(), 0);
  listen(listener_.get(), 4);
}

void ScriptedServer::drop_client() {
  client_.reset();
  reader_ = {};
}

void ScriptedServer::take_little() {
  const int bytes = 4096;
  setsockopt(listener_.get(), SOL_SOCKET, SO_RCVBUF, &bytes, sizeof bytes);
}

bool ScriptedServer::accept() {
  drop_client();
  if (!readable(listener_)) return false;
  client_ = os::FileDescriptor(::accept(listener_.get(), nullptr, nullptr));
  return static_cast<bool>(client_);
}

std::optional<wire::ControlMessage> ScriptedServer::next_message() {
  for (;;) {
    wire::ControlMessage message;
    const auto status = reader_.next(message);
    if (status == wire::ControlReader::Status::message) return message;
    std::array<std::byte, 1024> bytes;
    if (status == wire::ControlReader::Status::broken || !readable(client_)) return {};
    const auto size = recv(client_.get(), bytes.data(), bytes.size(), 0);
    if (size <= 0) return {};
    reader_.push({bytes.data(), static_cast<std::size_t>(size)});
  }
}

std::optional<wire::InputDatagram> ScriptedServer::next_input() {
  std::array<std::byte, 2048> bytes;
  wire::InputDatagram input;
  if (!readable(udp_)) return {};
  const auto size = recv(udp_.get(), bytes.data(), bytes.size(), 0);
  std::array<std::byte, wire::kMaxInputDatagram> plain;
  std::size_t plain_size = 0;
  if (size < 0 ||
      inputs_.open({bytes.data(), static_cast<std::size_t>(size)}, plain, plain_size) !=
          wire::SealVerdict::good ||
      !wire::decode_input(std::span(plain).first(plain_size), input))
    return {};
  return input;
}

void ScriptedServer::forget_inputs() {
  std::byte byte;
  while (recv(udp_.get(), &byte, 1, MSG_DONTWAIT) >= 0) {
  }
}

void ScriptedServer::send(const wire::ControlMessage& message) {
  std::vector<std::byte> bytes;
  wire::encode_control(message, bytes);
  send_bytes(bytes);
}

void ScriptedServer::send_bytes(std::span<const std::byte> bytes) {
  [[maybe_unused]] const auto sent =
      ::send(client_.get(), bytes.data(), bytes.size(), MSG_NOSIGNAL);
}

std::vector<std::byte> ScriptedServer::sealed(const wire::Snapshot& snapshot) {
  std::array<std::byte, wire::kMaxDatagram> plain;
  const std::size_t size = wire::encode_snapshot(snapshot, plain);
  std::vector<std::byte> out(size + wire::kSealBytes);
  wire::seal_datagram(welcome_.snapshot_key, welcome_.client, ++sealed_,
                      std::span(plain).first(size), out);
  return out;
}

void ScriptedServer::send_snapshot(const wire::Snapshot& snapshot) {
  send_datagram(sealed(snapshot));
}

void ScriptedServer::send_datagram(std::span<const std::byte> bytes) {
  const auto to = os::loopback(hello_.udp_port);
  sendto(udp_.get(), bytes.data(), bytes.size(), 0, to.generic(), to.size());
}

bool ScriptedServer::welcome(std::uint64_t session, std::uint64_t token, std::uint8_t team) {
  if (!accept()) return false;
  const auto message = next_message();
  if (!message || !std::holds_alternative<wire::Hello>(*message)) return false;
  hello_ = std::get<wire::Hello>(*message);
  wire::Welcome welcome;
  welcome.session = session;
  welcome.token = token;
  welcome.udp_port = udp_port_;
  welcome.layout = 1;
  welcome.team = team;
  welcome.client = ++welcomed_;
  for (std::size_t i = 0; i < welcome.input_key.size(); ++i) {
    welcome.input_key[i] = static_cast<std::byte>(welcomed_ + i);
    welcome.snapshot_key[i] = static_cast<std::byte>(welcomed_ + 100 + i);
  }
  welcome_ = welcome;
  inputs_ = {welcome.input_key, welcome.client};
  sealed_ = 0;
  send(welcome);
  return true;
}

}  // namespace client
