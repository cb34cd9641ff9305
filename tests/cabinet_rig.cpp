#include "cabinet_rig.h"

#include <arpa/inet.h>
#include <fcntl.h>
#include <netinet/in.h>
#include <poll.h>

#include <stdexcept>

#include "wire/control.h"

namespace end_to_end {
namespace {

constexpr int kDeadlineMs = 5000;

sockaddr_in loopback(std::uint16_t port) {
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_port = htons(port);
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  return address;
}

void require(bool held, const char* what) {
  if (!held) throw std::runtime_error(what);
}

// A device of 64-byte reports; the other end is where the simulator's reports go.
std::unique_ptr<cabinet::DeviceSource> report_device(std::vector<int>& writing_ends) {
  int ends[2];
  require(socketpair(AF_UNIX, SOCK_SEQPACKET | SOCK_NONBLOCK | SOCK_CLOEXEC, 0, ends) == 0,
          "socketpair failed");
  writing_ends.push_back(ends[0]);
  cabinet::DeviceOptions options;
  options.framing = cabinet::DeviceFraming::report;
  return std::make_unique<cabinet::DeviceSource>(
      options, [reading = ends[1]]() mutable { return std::exchange(reading, -1); });
}

}  // namespace

CabinetRig::CabinetRig(foosball::Layout layout) {
  server::ServerOptions options;
  options.match.layout = layout;
  options.session = 0x5EED;
  options.random = [token = std::uint64_t{1}]() mutable { return token++; };
  auto created = server::Server::create(std::move(options));
  require(created.has_value(), "the server does not start");
  server_ = std::move(*created);
  server_->add_device(report_device(report_ends_));
  tap_ = report_device(report_ends_);
  join();
  while (!sim_.all_enabled()) step();
}

CabinetRig::~CabinetRig() {
  for (const int end : report_ends_) close(end);
  if (udp_ >= 0) close(udp_);
  if (tcp_ >= 0) close(tcp_);
}

void CabinetRig::join() {
  udp_ = socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0);
  sockaddr_in mine = loopback(0);
  socklen_t size = sizeof mine;
  require(bind(udp_, reinterpret_cast<sockaddr*>(&mine), size) == 0, "bind failed");
  require(getsockname(udp_, reinterpret_cast<sockaddr*>(&mine), &size) == 0, "no socket name");

  tcp_ = socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0);
  const sockaddr_in server = loopback(server_->port());
  require(connect(tcp_, reinterpret_cast<const sockaddr*>(&server), sizeof server) == 0,
          "cannot connect to the server");
  wire::Hello hello;
  hello.snapshot_layout = wire::snapshot_layout_hash();
  hello.name = "rig";
  hello.udp_port = ntohs(mine.sin_port);
  std::vector<std::byte> bytes;
  wire::encode_control(hello, bytes);
  require(send(tcp_, bytes.data(), bytes.size(), 0) == static_cast<ssize_t>(bytes.size()),
          "cannot say Hello");

  wire::ControlReader reader;
  wire::ControlMessage message;
  while (reader.next(message) != wire::ControlReader::Status::message) {
    pollfd ready{tcp_, POLLIN, 0};
    require(poll(&ready, 1, kDeadlineMs) == 1, "no Welcome in time");
    std::byte buffer[4096];
    const ssize_t got = recv(tcp_, buffer, sizeof buffer, 0);
    require(got > 0, "the server closed the connection");
    reader.push({buffer, static_cast<std::size_t>(got)});
  }
  require(std::holds_alternative<wire::Welcome>(message), "not welcome");
  // The tick learns of a new listener through a queue: the first snapshot says that it has.
  for (int i = 0; i < kDeadlineMs && first_; ++i) {
    sim_.advance_us(1000);
    forward_reports();
    server_->tick(static_cast<std::int64_t>(sim_.now_us()));
    pollfd ready{udp_, POLLIN, 0};
    if (poll(&ready, 1, 1) == 1) {
      require(receive(last_), "the first snapshot does not decode");
      first_ = false;
    }
  }
  require(!first_, "no snapshot after joining");
}

bool CabinetRig::receive(wire::Snapshot& snapshot) {
  pollfd ready{udp_, POLLIN, 0};
  if (poll(&ready, 1, kDeadlineMs) != 1) return false;
  std::byte buffer[2048];
  const ssize_t got = recv(udp_, buffer, sizeof buffer, 0);
  return got > 0 && wire::decode_snapshot({buffer, static_cast<std::size_t>(got)}, snapshot);
}

void CabinetRig::forward_reports() {
  for (const firmware_sim::Report& report : sim_.take_reports()) {
    for (const int end : report_ends_) {
      require(send(end, report.bytes.data(), report.bytes.size(), 0) ==
                  static_cast<ssize_t>(report.bytes.size()),
              "a report was not taken");
    }
  }
  tap_->poll(static_cast<std::int64_t>(sim_.now_us()));
}

const wire::Snapshot& CabinetRig::step() {
  sim_.advance_us(1000);
  forward_reports();
  server_->tick(static_cast<std::int64_t>(sim_.now_us()));
  const std::uint64_t before = last_.tick;
  if (!receive(last_) || last_.tick != before + 1) ++missed_;
  return last_;
}

}  // namespace end_to_end
