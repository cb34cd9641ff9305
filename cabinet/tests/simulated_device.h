// What the firmware sends, made by hand: eight sensors with exact counts, and ways to carry the
// bytes.
#pragma once

#include <fcntl.h>
#include <gtest/gtest.h>
#include <pty.h>
#include <sys/socket.h>
#include <unistd.h>

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "cabinet/rod_input.h"
#include "wire/device_frame.h"

namespace cabinet_test {

using Bytes = std::vector<std::uint8_t>;

inline Bytes cobs(const wire::DeviceFrame& frame) {
  std::uint8_t plain[wire::kDeviceFrameBytes];
  wire::encode_device_frame(frame, plain);
  Bytes coded(wire::kDeviceCobsBytes);
  wire::cobs_encode(plain, sizeof plain, coded.data());
  return coded;
}

inline Bytes report(const wire::DeviceFrame& frame) {
  Bytes bytes(wire::kDeviceReportBytes);
  wire::encode_device_frame(frame, bytes.data());
  return bytes;
}

// The micro-controller: true counts without wraps, a clock and a sequence.
struct SimulatedDevice {
  std::array<std::int64_t, cabinet::kRods> slide{}, spin{};  // counts since it was started
  std::uint32_t time_us = 1'000'000;
  std::uint16_t sequence = 0;
  std::uint8_t present = 0xFF;

  wire::DeviceFrame frame(std::uint32_t period_us = 4'000) {
    time_us += period_us;
    ++sequence;
    wire::DeviceFrame made{};
    made.sequence = sequence;
    made.time_us = time_us;
    made.present = present;
    for (int rod = 0; rod < cabinet::kRods; ++rod) {
      made.slide[rod] = static_cast<std::uint16_t>(slide[rod]);
      made.spin[rod] = static_cast<std::uint16_t>(spin[rod]);
    }
    return made;
  }
};

struct Descriptor {
  int fd = -1;
  Descriptor() = default;
  explicit Descriptor(int open) : fd(open) {}
  Descriptor(const Descriptor&) = delete;
  Descriptor& operator=(const Descriptor&) = delete;
  ~Descriptor() { close(); }
  void close() {
    if (fd >= 0) ::close(fd);
    fd = -1;
  }
  void send(const Bytes& bytes) const {
    ASSERT_EQ(send_what_fits(bytes), static_cast<ssize_t>(bytes.size()));
  }
  // For a line that nobody reads yet: what does not fit is dropped, as by a real device. Neither of
  // the two ever waits: a full line without a reader would make a test wait for ever.
  ssize_t send_what_fits(const Bytes& bytes) const {
    const int flags = ::fcntl(fd, F_GETFL);
    ::fcntl(fd, F_SETFL, flags | O_NONBLOCK);
    const ssize_t sent = ::write(fd, bytes.data(), bytes.size());
    ::fcntl(fd, F_SETFL, flags);
    return sent;
  }
};

// A serial line: the master's end is the micro-controller, path() what the PC opens.
struct SerialLine {
  Descriptor master;
  std::string path;
  void plug() {
    int slave = -1;
    char name[256];
    ASSERT_EQ(openpty(&master.fd, &slave, name, nullptr, nullptr), 0);
    ::close(slave);
    path = name;
  }
  void unplug() {
    master.close();
    path.clear();
  }
  int open() const {
    return path.empty() ? -1 : ::open(path.c_str(), O_RDONLY | O_NONBLOCK | O_NOCTTY | O_CLOEXEC);
  }
};

}  // namespace cabinet_test
