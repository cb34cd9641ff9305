#include "cabinet_rig.h"

#include <fcntl.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <array>
#include <span>
#include <stdexcept>
#include <utility>

#include "cabinet/device_haptics.h"
#include "os/socket_address.h"
#include "wire/device_frame.h"

namespace end_to_end {
namespace {

constexpr int kDeadlineMs = 5000;

void require(bool held, const char* what) {
  if (!held) throw std::runtime_error(what);
}

}  // namespace

void CabinetRig::connect_cable(Cable& cable) {
  int ends[2];
  require(socketpair(AF_UNIX, SOCK_SEQPACKET | SOCK_NONBLOCK | SOCK_CLOEXEC, 0, ends) == 0,
          "socketpair failed");
  cable = {ends[0], ends[1]};
}

std::unique_ptr<cabinet::DeviceSource> CabinetRig::device_on(Cable& cable) {
  cabinet::DeviceOptions options;
  options.framing = cabinet::DeviceFraming::report;
  return std::make_unique<cabinet::DeviceSource>(
      options, [&cable] { return std::exchange(cable.reading, -1); });
}

CabinetRig::CabinetRig(foosball::Layout layout) {
  server::ServerOptions options;
  options.match.layout = layout;
  options.session = 0x5EED;
  options.random = [token = std::uint64_t{1}]() mutable { return token++; };
  auto created = server::Server::create(std::move(options));
  require(created.has_value(), "the server does not start");
  server_ = std::move(*created);
  connect_cable(to_server_);
  connect_cable(to_tap_);
  auto device = device_on(to_server_);
  auto motors = std::make_unique<cabinet::CabinetHaptics>();
  motors->add(*device);
  server_->set_cabinet_haptics(std::move(motors));
  server_->add_device(std::move(device));
  tap_ = device_on(to_tap_);
  join();
  while (!sim_.all_enabled()) step();
}

CabinetRig::~CabinetRig() {
  for (const Cable& cable : {to_server_, to_tap_}) {
    if (cable.writing >= 0) close(cable.writing);
    if (cable.reading >= 0) close(cable.reading);
  }
  if (udp_ >= 0) close(udp_);
  if (tcp_ >= 0) close(tcp_);
}

void CabinetRig::join() {
  udp_ = socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0);
  const auto mine = os::loopback(0);
  require(bind(udp_, mine.generic(), mine.size()) == 0, "bind failed");

  tcp_ = socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0);
  const auto server = os::loopback(server_->port());
  require(connect(tcp_, server.generic(), server.size()) == 0, "cannot connect to the server");
  wire::Hello hello;
  hello.snapshot_layout = wire::snapshot_layout_hash();
  hello.name = "rig";
  hello.udp_port = os::local_address(udp_).port();
  std::vector<std::byte> bytes;
  wire::encode_control(hello, bytes);
  require(send(tcp_, bytes.data(), bytes.size(), 0) == static_cast<ssize_t>(bytes.size()),
          "cannot say Hello");

  wire::ControlMessage message;
  require(next_message(kDeadlineMs, message), "no Welcome in time");
  const auto* welcome = std::get_if<wire::Welcome>(&message);
  require(welcome != nullptr, "not welcome");
  opener_ = {welcome->snapshot_key, welcome->client};
  // The tick receives a new listener through a queue: the first snapshot shows that it has.
  for (int i = 0; i < kDeadlineMs && first_; ++i) {
    sim_.advance_us(1000);
    forward_reports();
    tick();
    pollfd ready{udp_, POLLIN, 0};
    if (poll(&ready, 1, 1) == 1) {
      require(receive(last_), "the first snapshot does not decode");
      first_ = false;
    }
  }
  require(!first_, "no snapshot after joining");
}

// False if there is none by the deadline.
bool CabinetRig::next_message(int deadline_ms, wire::ControlMessage& message) {
  for (;;) {
    const auto status = reader_.next(message);
    if (status == wire::ControlReader::Status::message) return true;
    require(status == wire::ControlReader::Status::need_more, "the server's bytes are broken");
    pollfd ready{tcp_, POLLIN, 0};
    if (poll(&ready, 1, deadline_ms) != 1) return false;
    std::byte buffer[4096];
    const ssize_t got = recv(tcp_, buffer, sizeof buffer, 0);
    require(got > 0, "the server closed the connection");
    reader_.push({buffer, static_cast<std::size_t>(got)});
  }
}

std::vector<wire::Notice> CabinetRig::notices() {
  std::vector<wire::Notice> found;
  wire::ControlMessage message;
  while (next_message(0, message)) {
    if (const auto* notice = std::get_if<wire::Notice>(&message)) found.push_back(*notice);
  }
  return found;
}

std::optional<wire::Notice> CabinetRig::next_notice() {
  wire::ControlMessage message;
  while (next_message(kDeadlineMs, message)) {
    if (const auto* notice = std::get_if<wire::Notice>(&message)) return *notice;
  }
  return std::nullopt;
}

void CabinetRig::unplug() {
  close(to_server_.writing);
  to_server_.writing = -1;
}

void CabinetRig::plug_in() {
  connect_cable(to_server_);
}

bool CabinetRig::receive(wire::Snapshot& snapshot) {
  pollfd ready{udp_, POLLIN, 0};
  if (poll(&ready, 1, kDeadlineMs) != 1) return false;
  std::byte buffer[2048];
  const ssize_t got = recv(udp_, buffer, sizeof buffer, 0);
  if (got <= 0) return false;
  std::byte plain[wire::kMaxDatagram];
  std::size_t size = 0;
  return opener_.open({buffer, static_cast<std::size_t>(got)}, plain, size) ==
             wire::SealVerdict::good &&
         wire::decode_snapshot({plain, size}, snapshot);
}

void CabinetRig::forward_reports() {
  for (const firmware_sim::Report& report : sim_.take_reports()) {
    for (const int end : {to_server_.writing, to_tap_.writing}) {
      if (end < 0) continue;
      require(send(end, report.bytes.data(), report.bytes.size(), MSG_NOSIGNAL) ==
                  static_cast<ssize_t>(report.bytes.size()),
              "a report was not taken");
    }
  }
  tap_->poll(static_cast<std::int64_t>(sim_.now_us()));
}

// As hidraw takes them: the report's number, then the report.
void CabinetRig::forward_commands() {
  if (to_server_.writing < 0) return;
  std::array<std::uint8_t, 1 + wire::kDeviceReportBytes> bytes{};
  while (recv(to_server_.writing, bytes.data(), bytes.size(), MSG_DONTWAIT) ==
         static_cast<ssize_t>(bytes.size())) {
    sim_.send(std::span(bytes).subspan(1));
  }
}

std::uint64_t CabinetRig::haptic_pulses() const {
  return server_->counters().haptic_pulses;
}

void CabinetRig::tick() {
  server_->tick(static_cast<std::int64_t>(sim_.now_us()));
  server_->wait_sent();
  forward_commands();
}

const wire::Snapshot& CabinetRig::step() {
  sim_.advance_us(1000);
  forward_reports();
  tick();
  const std::uint64_t before = last_.tick;
  if (!receive(last_) || last_.tick != before + 1) ++missed_;
  return last_;
}

}  // namespace end_to_end
