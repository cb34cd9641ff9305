// The cabinet's micro-controller, read from a file descriptor: a serial line or pty (COBS frames),
// a hidraw node or socket (64-byte reports), or a recording of either.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <tl/expected.hpp>

#include "cabinet/calibration.h"
#include "cabinet/device.h"

namespace wire {
struct DeviceFrame;
}

namespace cabinet {

enum class DeviceFraming : std::uint8_t { cobs, report };

struct DeviceOptions {
  std::string name = "cabinet";
  DeviceFraming framing = DeviceFraming::cobs;
  Calibration calibration = nominal_calibration();
  // slide| is clamped to it [m]; 0: no limit. With a limit, moving a handle to its stop removes
  // drift.
  std::array<double, kRods> slide_limit{};
  std::int64_t silence_us = 50'000;  // without a frame for this long, rods become held
  std::int64_t reopen_us = 200'000;  // between attempts to open a disconnected device
  bool opener_sets_line = false;     // the opener has already set a tty to raw 1 Mbaud
  // When bytes last arrived on the open line, on the clock passed to poll() [us]. Null: arrival is
  // only known to lie between two polls.
  std::function<std::int64_t()> arrived_us;
  // Sends a packet to the descriptor from another thread, for descriptors whose write(2) blocks,
  // such as hidraw. Returns false if it cannot send now. Null: such a device gets no packets.
  std::function<bool(int, std::span<const std::byte>)> send_apart;
  // The calibration of the device that the opener has just opened; a null result keeps the previous
  // one. Called from poll(): it must not block. Null: `calibration` is always used.
  std::function<const Calibration*()> calibration_of_open;
};

// Opens the device and returns its descriptor, which the source then owns, or -1 and errno (the
// source tries again). The source detects the type from the descriptor: it sets a tty to raw 1
// Mbaud. A regular file is a recording (either framing, detected from its bytes), paced by the
// micro-controller's clock and played once. The source makes the descriptor non-blocking. Called
// from poll(): it must not block.
using DeviceOpener = std::function<int()>;
// Takes the descriptor back. Called from poll(): it must not block. Null: close(2).
using DeviceCloser = std::function<void(int)>;

// A rod is absent until its mouse first reports; then it is live or held. Positions start at 0 and
// change only by the sensors' increments. After a pause, a reconnection or a restart of the
// micro-controller they continue from the held position. One thread at a time.
class DeviceSource final : public Device {
 public:
  DeviceSource(DeviceOptions options, DeviceOpener open, DeviceCloser close = {});
  ~DeviceSource() override;

  void poll(std::int64_t now_us) override;
  const RodInputs& rods() const override;
  const SourceCounters& counters() const override;
  const std::string& name() const override;
  DeviceState state() const override;
  int open_error() const override;
  const RodCounts& counts() const override;
  // The observer is called from poll() with the raw counts of each accepted frame. Null: removes
  // it.
  void observe(std::function<void(const wire::DeviceFrame&)> observer);
  // Sends a packet from host to device, such as a haptic pulse (cabinet/haptics.h), already encoded
  // for the line. A hidraw node, whose write(2) waits for the USB transfer, uses
  // DeviceOptions::send_apart. Never blocks and never sends part of a packet. Returns false if
  // nothing is connected, if the line cannot take the complete packet, and for a recording. Call it
  // between polls, on their thread.
  bool send(std::span<const std::byte> packet);
  DeviceFraming framing() const;
  // The micro-controller's time of the last accepted frame [us], for the latency test.
  std::uint32_t last_frame_time_us() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

// An address is "serial:/dev/ttyACM0", "hid:/dev/hidraw0" or "file:recording.bin". An unknown
// scheme, a missing recording, a path that is not a device and one that is not readable give an
// error sentence. A device that is not connected yet is not an error.
//
// why_no_device() returns only the sentence, or empty. It needs no calibration.
//
// poll() of the source never blocks: a separate thread opens, configures and closes the device. It
// finds a device within two attempts, 200 ms. open_device() reads a complete recording (at most 64
// MiB, 6 hours).
std::string why_no_device(const std::string& address);
//
// find: looks up the calibration of the connected controller whenever one is plugged in, as it may
// be a different one. An empty result keeps the previous calibration. Runs on the opening thread:
// it may block.
using CalibrationFinder = std::function<std::optional<Calibration>()>;
tl::expected<std::unique_ptr<DeviceSource>, std::string> open_device(
    const std::string& address, const Calibration& calibration,
    const std::array<double, kRods>& slide_limit = {}, CalibrationFinder find = {});

}  // namespace cabinet
