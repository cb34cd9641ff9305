// What is connected to this machine that can move rods, how well it does, and what to do about it.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <string>
#include <tl/expected.hpp>
#include <vector>

#include "cabinet/device.h"

namespace cabinet {

enum class DeviceKind : std::uint8_t { hid_controller, serial_controller, mouse, gamepad };

// How a rod did while nobody was to touch it.
struct RodCheck {
  RodStatus status = RodStatus::absent;
  double slide_range = 0, angle_range = 0;  // how far it moved [m], [rad]
};

struct FoundDevice {
  DeviceKind kind = DeviceKind::mouse;
  std::string path;            // of its node below dev, or as it was named
  std::string name;            // what it calls itself: a stranger's words
  std::string usb_id, serial;  // of a controller, as it tells over USB; empty: not told
  bool named = false;          // by DoctorOptions::devices
  bool listens = true;         // false: a serial line that is not known as ours, and not opened
  bool calibrated = false;     // of a controller: a file is named, or kept for it
  std::string calibration_conflict;  // empty, or that this file is another controller's
  int error = 0;                     // errno of opening it to read; 0: it may be read
  // Of one that was listened to:
  DeviceState state = DeviceState::missing;
  double seconds = 0;  // of a controller: from its first frame on
  SourceCounters counters;
  std::array<RodCheck, kRods> rods{};     // of a mouse, the first: a rod in its hand
  double reports_per_s = 0;               // of a mouse or gamepad, while it moved; 0: it did not
  double stick_peak = 0, stick_rest = 0;  // off the middle, of a stick's full way; rest: at the end
};

struct CalibrationCheck {
  std::string device;  // the address of the controller that it is kept for; empty: it was named
  std::string path;
  std::string error;  // a sentence without its full stop; empty: it is well
  double days = 0;    // since it was made, by what it says, else by the file's time
};

struct Trouble {
  std::string device;  // its path, or empty
  std::string what;    // a sentence without its full stop
  std::string cure;    // what to do, likewise
};

struct Diagnosis {
  std::vector<FoundDevice> devices;
  std::vector<CalibrationCheck> calibrations;
  std::vector<Trouble> troubles;
};

// "serial:PATH", "hid:PATH" or "evdev:PATH".
struct DoctorAddress {
  DeviceKind kind;
  std::string path;
};
tl::expected<DoctorAddress, std::string> parse_doctor_address(const std::string& text);

struct DoctorOptions {
  std::string dev = "/dev", sys = "/sys";
  std::vector<DoctorAddress> devices;  // to be looked at beside those that are known as ours
  std::string calibration;             // a file for all controllers, or empty: each its own
  std::string calibrations;  // the folder of those that are kept (cabinet/controller.h), or empty
  double seconds = 2;        // for each controller, and for mice and gamepads together
  std::int64_t now_s = 0;    // time of day, for the calibration's age
  // Waits for the next poll and returns its time on a monotonic clock [us]. None: each millisecond.
  std::function<std::int64_t()> next_poll;
};

// Listens to controllers, each by itself, for options.seconds from its first frame on; waits for
// that frame for as long and 3 s more (a board may restart when it is opened). Then to all mice and
// gamepads at once.
Diagnosis examine(const DoctorOptions& options);

// For a person: every trouble with its cure. For a program: one JSON object.
std::string diagnosis_text(const Diagnosis& diagnosis);
std::string diagnosis_json(const Diagnosis& diagnosis);

}  // namespace cabinet
