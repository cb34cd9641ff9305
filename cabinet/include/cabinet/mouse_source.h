// A mouse of this machine as one rod: an ordinary hand mouse, or one that tracks a broomstick. Read
// from the kernel (evdev), so that each of several mice is its own rod and does not move the
// desktop's pointer.
#pragma once

#include <memory>
#include <string>
#include <tl/expected.hpp>

#include "cabinet/calibration.h"
#include "cabinet/device.h"
#include "cabinet/device_source.h"

namespace cabinet {

// For a hand mouse of 1000 counts per inch. Motion to the right slides the rod 1.5 times as far.
// Forward motion turns it: 23 mm for a full swing of 1.4 rad. Signs for team 0: both +1.
RodCalibration hand_mouse(double slide_sign, double angle_sign);

struct MouseOptions {
  std::string name = "mouse";
  int rod = 3;                                    // 0..7 from -x
  RodCalibration calibration = hand_mouse(1, 1);  // of (right, forward) counts
  double slide_limit = 0.0;                       // slide| is clamped to it [m]; 0: no limit
  std::int64_t reopen_us = 200'000;               // between attempts to open a disconnected mouse
};

// The rod is absent until the mouse is first open. It is live while the mouse is open, even without
// motion reports, and held once the mouse is disconnected. Time stamps come from the kernel, on the
// clock passed to poll(). One that does not lie within the last second counts as now. One thread at
// a time.
class MouseSource final : public Device {
 public:
  // open: returns a descriptor that delivers struct input_event, or -1 and errno. The source makes
  // the descriptor non-blocking. poll() calls open and close: neither may block.
  MouseSource(MouseOptions options, DeviceOpener open, DeviceCloser close = {});
  ~MouseSource() override;

  void poll(std::int64_t now_us) override;
  const RodInputs& rods() const override;
  // frames: motion reports. lost: times at which the kernel dropped events. stale: reports without
  // a valid time. Latency is from the kernel's stamp to the poll.
  const SourceCounters& counters() const override;
  const std::string& name() const override;
  DeviceState state() const override;
  int open_error() const override;
  const RodCounts& counts() const override;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

struct MouseAddress {
  std::string path;
  int rod = -1;  // 0..7; -1: not given in the address
};

// "evdev:/dev/input/event5", or with a rod from 1 (at -x) to 8: "evdev:/dev/input/event5:4". The
// error is a sentence.
tl::expected<MouseAddress, std::string> parse_mouse_address(const std::string& address);
bool is_mouse_address(const std::string& address);

// Grabs the mouse: no other program or second server gets its events. The error is a sentence, for
// a device that is not a mouse or not readable. A mouse that is not connected yet is not an error.
// A separate thread opens it.
tl::expected<std::unique_ptr<MouseSource>, std::string> open_mouse(const std::string& path,
                                                                   MouseOptions options);

}  // namespace cabinet
