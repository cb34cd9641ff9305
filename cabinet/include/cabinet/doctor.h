// Diagnoses the devices of this machine that can move rods: which are connected, how well they
// work, and how to fix them.
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

// State of a rod while nobody was supposed to touch it.
struct RodCheck {
  RodStatus status = RodStatus::absent;
  double slide_range = 0, angle_range = 0;  // extent of its motion [m], [rad]
};

struct FoundDevice {
  DeviceKind kind = DeviceKind::mouse;
  std::string path;                  // of its node below `dev`, or as given in DoctorOptions
  std::string name;                  // as the device reports it: untrusted text
  std::string usb_id, serial;        // of a controller, as reported over USB; empty: not reported
  bool named = false;                // listed in DoctorOptions::devices
  bool listens = true;               // false: a serial line not known as ours, so not opened
  bool calibrated = false;           // of a controller: its file is given, or stored for it
  std::string calibration_conflict;  // empty, or: the file belongs to another controller
  int error = 0;                     // errno of opening it for reading; 0: readable
  // Results of listening to it:
  DeviceState state = DeviceState::missing;
  double seconds = 0;  // of a controller: since its first frame
  SourceCounters counters;
  std::array<RodCheck, kRods> rods{};  // of a mouse, the first entry: as a hand mouse
  double reports_per_s = 0;            // of a mouse or gamepad, while it moved; 0: it did not move
  double stick_peak = 0, stick_rest = 0;  // deflection, fraction of full; rest: at the end
};

struct CalibrationCheck {
  std::string device;  // address of the controller that it is stored for; empty: given by path
  std::string path;
  std::string error;  // a sentence without its full stop; empty: valid
  double days = 0;    // since it was made, by its own date, else by the file's time
};

struct Trouble {
  std::string device;  // its path, or empty
  std::string what;    // a sentence without its full stop
  std::string cure;    // what to do, a sentence without its full stop
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
  std::vector<DoctorAddress> devices;  // examined in addition to those known as ours
  std::string calibration;             // a file for all controllers; empty: each its own
  std::string calibrations;  // folder of stored calibrations (cabinet/controller.h), or empty
  double seconds = 2;        // for each controller, and for mice and gamepads together
  std::int64_t now_s = 0;    // time of day, to compute the age of a calibration
  // Waits for the next poll and returns its time on a monotonic clock [us]. Null: every
  // millisecond.
  std::function<std::int64_t()> next_poll;
};

// Listens to each controller in turn for options.seconds from its first frame. Waits for that frame
// for the same time plus 3 s (a board may restart when it is opened). Then listens to all mice and
// gamepads at once.
Diagnosis examine(const DoctorOptions& options);

// Text lists each trouble with its cure for a person. JSON is one object for a program.
std::string diagnosis_text(const Diagnosis& diagnosis);
std::string diagnosis_json(const Diagnosis& diagnosis);

}  // namespace cabinet
