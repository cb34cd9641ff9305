#include "scripted_server.h"

#include <arpa/inet.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <array>

namespace client {
namespace {

sockaddr_in loopback(std::uint16_t port) {
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  address.sin_port = htons(port);
  return address;
}

std::uint16_t bind_to(int fd, std::uint16_t port) {
  const int on = 1;
  setsockopt(fd, SOL_SOCKET, SO_REUSEADDR, &on, sizeof on);
  sockaddr_in address = loopback(port);
  if (bind(fd, reinterpret_cast<sockaddr*>(&address), sizeof address) != 0) return 0;
  socklen_t size = sizeof address;
  getsockname(fd, reinterpret_cast<sockaddr*>(&address), &size);
  return ntohs(address.sin_port);
}

bool readable(int fd) {
  pollfd polled{fd, POLLIN, 0};
  return fd >= 0 && poll(&polled, 1, static_cast<int>(ScriptedServer::kPatience.count())) == 1;
}

}  // namespace

ScriptedServer::ScriptedServer(std::uint16_t port)
    : listener_(socket(AF_INET, SOCK_STREAM, 0)), udp_(socket(AF_INET, SOCK_DGRAM, 0)) {
  port_ = bind_to(listener_, port);
  udp_port_ = bind_to(udp_, 0);
  listen(listener_, 4);
}

ScriptedServer::~ScriptedServer() {
  drop_client();
  close(udp_);
  close(listener_);
}

void ScriptedServer::drop_client() {
  if (client_ >= 0) close(client_);
  client_ = -1;
  reader_ = {};
}

bool ScriptedServer::accept() {
  drop_client();
  if (!readable(listener_)) return false;
  client_ = ::accept(listener_, nullptr, nullptr);
  return client_ >= 0;
}

std::optional<wire::ControlMessage> ScriptedServer::next_message() {
  for (;;) {
    wire::ControlMessage message;
    const auto status = reader_.next(message);
    if (status == wire::ControlReader::Status::message) return message;
    std::array<std::byte, 1024> bytes;
    if (status == wire::ControlReader::Status::broken || !readable(client_)) return {};
    const auto size = recv(client_, bytes.data(), bytes.size(), 0);
    if (size <= 0) return {};
    reader_.push({bytes.data(), static_cast<std::size_t>(size)});
  }
}

std::optional<wire::InputDatagram> ScriptedServer::next_input() {
  std::array<std::byte, 2048> bytes;
  wire::InputDatagram input;
  if (!readable(udp_)) return {};
  const auto size = recv(udp_, bytes.data(), bytes.size(), 0);
  if (size < 0 || !wire::decode_input({bytes.data(), static_cast<std::size_t>(size)}, input))
    return {};
  return input;
}

void ScriptedServer::forget_inputs() {
  std::byte byte;
  while (recv(udp_, &byte, 1, MSG_DONTWAIT) >= 0) {
  }
}

void ScriptedServer::send(const wire::ControlMessage& message) {
  std::vector<std::byte> bytes;
  wire::encode_control(message, bytes);
  send_bytes(bytes);
}

void ScriptedServer::send_bytes(std::span<const std::byte> bytes) {
  [[maybe_unused]] const auto sent = ::send(client_, bytes.data(), bytes.size(), MSG_NOSIGNAL);
}

void ScriptedServer::send_snapshot(const wire::Snapshot& snapshot) {
  std::array<std::byte, wire::kMaxDatagram> bytes;
  send_datagram({bytes.data(), wire::encode_snapshot(snapshot, bytes)});
}

void ScriptedServer::send_datagram(std::span<const std::byte> bytes) {
  const sockaddr_in to = loopback(hello_.udp_port);
  sendto(udp_, bytes.data(), bytes.size(), 0, reinterpret_cast<const sockaddr*>(&to), sizeof to);
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
  send(welcome);
  return true;
}

}  // namespace client
