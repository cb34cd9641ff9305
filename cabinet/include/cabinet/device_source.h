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
  // |slide| never passes it [m]; 0: no limit. Pushing a handle to its stop then takes out any
  // drift.
  std::array<double, kRods> slide_limit{};
  std::int64_t silence_us = 50'000;  // no frame for so long: the rods hold
  std::int64_t reopen_us = 200'000;  // between attempts to open a device that went away
  bool opener_sets_line = false;     // a tty comes as raw 1 Mbaud already
  // When bytes last came on the line that is open, on the clock that is handed to poll() [us].
  // None: only known to lie between two polls.
  std::function<std::int64_t()> arrived_us;
  // Sends a packet to the descriptor from another thread, where write(2) would wait, as at hidraw;
  // false: not now. None: nothing is sent to such a device.
  std::function<bool(int, std::span<const std::byte>)> send_apart;
  // Of the device that the opener has just opened; null: as before. Called from poll(), so it never
  // waits. None: the one above.
  std::function<const Calibration*()> calibration_of_open;
};

// Opens the device and returns the descriptor, which then belongs to the source, or -1 and errno
// (it is tried again). What it is shows from the descriptor: a tty is set to raw 1 Mbaud, a regular
// file is a recording (either framing, seen from its bytes), paced by the micro-controller's clock
// and played once. It is made non-blocking. Called from poll(): it must not wait.
using DeviceOpener = std::function<int()>;
// Takes the descriptor back, from poll() too and under the same rule. None: close(2).
using DeviceCloser = std::function<void(int)>;

// A rod is absent until its mouse was first heard; from then on live or held. Positions start at 0
// and only ever change by the sensors' increments: after a pause, a replug or a restart of the
// micro-controller they go on from where they were held. One thread at a time.
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
  // Called from poll() with each frame that is accepted: the raw counts. None: no longer.
  void observe(std::function<void(const wire::DeviceFrame&)> observer);
  // A packet against the way of the frames, such as a haptic pulse (cabinet/haptics.h), as it is on
  // the line; at hidraw, whose write(2) waits for the USB transfer, by DeviceOptions::send_apart.
  // Never waits and never sends a part of one: false where nothing is attached, where the line has
  // no room for all of it, and at a recording. Between polls, on their thread.
  bool send(std::span<const std::byte> packet);
  DeviceFraming framing() const;
  // For the latency test: the micro-controller's clock of the last accepted frame [us].
  std::uint32_t last_frame_time_us() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

// "serial:/dev/ttyACM0", "hid:/dev/hidraw0" or "file:recording.bin"; an unknown scheme is an error
// sentence, and so are a recording that is missing, a path that is no device and one that may not
// be read. A device that is not there yet is not an error.
//
// why_no_device() is the sentence alone, or empty, before there is a calibration.
//
// poll() of the source never waits: a device is opened, set up and closed on a thread of its own,
// and found within two attempts, 200 ms; a recording (64 MiB at most, 6 hours) is read whole here.
std::string why_no_device(const std::string& address);
//
// find: the calibration of the controller that is there, looked for whenever one is plugged in, so
// that it may be another; nothing: as before. On the thread that opens: it may wait.
using CalibrationFinder = std::function<std::optional<Calibration>()>;
tl::expected<std::unique_ptr<DeviceSource>, std::string> open_device(
    const std::string& address, const Calibration& calibration,
    const std::array<double, kRods>& slide_limit = {}, CalibrationFinder find = {});

}  // namespace cabinet
