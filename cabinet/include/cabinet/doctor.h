// What is connected to this machine that can move rods, how well it does, and what to do about it.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "cabinet/device.h"

namespace cabinet {

enum class DeviceKind : std::uint8_t { hid_controller, serial_controller, mouse, gamepad };

// How a rod of a controller did while nobody was to touch it.
struct RodCheck {
  RodStatus status = RodStatus::absent;
  double slide_range = 0, angle_range = 0;  // how far it moved [m], [rad]
};

struct FoundDevice {
  DeviceKind kind = DeviceKind::mouse;
  std::string path;  // of its node below dev
  std::string name;  // what it calls itself: a stranger's words
  int error = 0;     // errno of opening it to read; 0: it may be read
  // Of a controller that was listened to:
  DeviceState state = DeviceState::missing;
  double seconds = 0;  // from its first frame on
  SourceCounters counters;
  std::array<RodCheck, kRods> rods{};
};

struct CalibrationCheck {
  std::string path;
  std::string error;  // a sentence; empty: it is well
  double days = 0;    // since it was written
};

struct Trouble {
  std::string device;  // its path, or empty
  std::string what;    // a sentence without its full stop
  std::string cure;    // what to do, likewise
};

struct Diagnosis {
  std::vector<FoundDevice> devices;
  std::optional<CalibrationCheck> calibration;
  std::vector<Trouble> troubles;
};

struct DoctorOptions {
  std::string dev = "/dev", sys = "/sys";
  std::string calibration;   // a file, or empty
  std::string calibrations;  // the folder of those that are kept (cabinet/controller.h), or empty
  double seconds = 2;        // for each controller
  std::int64_t now_s = 0;    // time of day, for the calibration's age
  // Waits for the next poll and returns its time on a monotonic clock [us]. None: each millisecond.
  std::function<std::int64_t()> next_poll;
};

// Listens to controllers, each by itself, for options.seconds from its first frame on; waits for
// that frame for as long and 3 s more (a board that is opened may start anew).
Diagnosis examine(const DoctorOptions& options);

// For a person: every trouble with its cure. For a program: one JSON object.
std::string diagnosis_text(const Diagnosis& diagnosis);
std::string diagnosis_json(const Diagnosis& diagnosis);

}  // namespace cabinet
