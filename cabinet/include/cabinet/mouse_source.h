// A mouse of the machine as one rod: what lies on the desk, or a mouse at a broomstick. Read from
// the kernel (evdev), so that two mice and more are each a rod of their own, and the desktop's
// pointer does not move with them.
#pragma once

#include <memory>
#include <string>
#include <tl/expected.hpp>

#include "cabinet/calibration.h"
#include "cabinet/device.h"
#include "cabinet/device_source.h"

namespace cabinet {

// Of a mouse in a hand, at 1000 counts an inch: to the right along the rod, 1.5 times as far;
// forward turns it, 23 mm for a full swing of 1.4 rad. Team 0's: +1 each.
RodCalibration hand_mouse(double slide_sign, double angle_sign);

struct MouseOptions {
  std::string name = "mouse";
  int rod = 3;                                    // 0..7 from -x
  RodCalibration calibration = hand_mouse(1, 1);  // of (to the right, forward), in counts
  double slide_limit = 0.0;                       // |slide| never passes it [m]; 0: no limit
  std::int64_t reopen_us = 200'000;               // between attempts to open a mouse that went away
};

// The rod is absent until the mouse was first open; then live while it is, although a mouse that is
// not moved says nothing, and held once it is gone. Time stamps are the kernel's, of the clock that
// is handed to poll(); one that is of no time between the last second and now counts as now.
// One thread at a time.
class MouseSource final : public Device {
 public:
  // open: returns a descriptor from which struct input_event can be read, or -1 and errno. The
  // descriptor is made non-blocking. Called from poll(), as is close: neither may wait.
  MouseSource(MouseOptions options, DeviceOpener open, DeviceCloser close = {});
  ~MouseSource() override;

  void poll(std::int64_t now_us) override;
  const RodInputs& rods() const override;
  // frames: reports of motion; lost: times at which the kernel dropped some; stale: reports without
  // a time; latency from the kernel's stamp to the poll.
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
  int rod = -1;  // 0..7; -1: the address names none
};

// "evdev:/dev/input/event5", or with a rod from 1 (at -x) to 8: "evdev:/dev/input/event5:4".
// Otherwise a sentence.
tl::expected<MouseAddress, std::string> parse_mouse_address(const std::string& address);
bool is_mouse_address(const std::string& address);

// Grabs the mouse: no other program hears it, and no second server has it. A sentence for one that
// is there but is no mouse, or may not be read; one that is not there yet is no error. It is opened
// on a thread of its own.
tl::expected<std::unique_ptr<MouseSource>, std::string> open_mouse(const std::string& path,
                                                                   MouseOptions options);

}  // namespace cabinet
