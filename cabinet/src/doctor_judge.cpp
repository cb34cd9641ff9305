#include "doctor_judge.h"

#include <fmt/format.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <numbers>

#include "cabinet/hand.h"
#include "doctor_find.h"

namespace cabinet {
namespace {

// A rod that nobody touches moves less: sensor noise is a count or two, 0.9 degrees each.
constexpr double kNoiseSlide = 0.5e-3, kNoiseAngle = 3 * std::numbers::pi / 180;
// A mouse that moves its rod this far is in use: about 500 counts. Noise is less.
constexpr double kHandSlide = 20e-3, kHandAngle = 45 * std::numbers::pi / 180;
constexpr double kHandStick = 0.5;  // deflection of a gamepad's stick in use, fraction of full
constexpr double kHidFrames = 900, kSerialFrames = 225;  // per second; 1000 and 250 are sent
constexpr double kMouseReports = 90;                     // per second; the slowest mice send 125
constexpr double kLatencyUs = 1'500;  // polling every 1 ms gives 0.5 ms on average
constexpr double kOldDays = 180;      // in half a year, sensors and rods get moved
const char* const kBusyCure =
    "end what keeps the machine busy; the server asks for real-time priority (CAP_SYS_NICE)";

struct KindText {
  const char* named;    // in a sentence of its own
  const char* a_class;  // class that a path may belong to
};

KindText text_of(DeviceKind kind) {
  switch (kind) {
    case DeviceKind::hid_controller:
      return {"the controller", "HID device"};
    case DeviceKind::serial_controller:
      return {"the controller", "serial line"};
    case DeviceKind::mouse:
      return {"the mouse", "mouse"};
    case DeviceKind::gamepad:
      break;
  }
  return {"the gamepad", "gamepad"};
}

Trouble not_readable(const FoundDevice& device) {
  const std::string what = text_of(device.kind).named;
  const std::string sentence =
      fmt::format("{} cannot be read: {}", what, std::strerror(device.error));
  switch (device.error) {
    case EACCES:
    case EPERM:
      if (device.kind == DeviceKind::serial_controller)
        return {device.path, sentence,
                "join the group of the port (sudo usermod -aG dialout $USER) and log in again"};
      return {device.path, sentence,
              "install cabinet/70-space-foosball.rules and plug it in again, or join group input "
              "and log in again"};
    case EBUSY:
      return {device.path, what + " is in use",
              "end the server, or the other program, that uses it"};
    case ENOENT:
    case ENOTDIR:
      if (device.named)
        return {device.path, what + " is not connected",
                "plug it in, or name it as \"ls /dev/ttyACM* /dev/ttyUSB* /dev/hidraw* "
                "/dev/input/event*\" has it"};
      return {device.path, what + " is known to the kernel but has no device file",
              "start udev; in a container pass the device in"};
    case ENOTTY:
      return {device.path, std::string("this is no ") + text_of(device.kind).a_class,
              "give one that is; without --device, all connected devices are listed"};
    default:
      return {device.path, sentence, "plug it in again, into another socket or with another cable"};
  }
}

void judge_frames(const FoundDevice& device, std::vector<Trouble>& troubles) {
  const auto add = [&](std::string what, std::string cure) {
    troubles.push_back({device.path, std::move(what), std::move(cure)});
  };
  const SourceCounters& c = device.counters;
  const double rate = frames_per_s(device);
  const double min = device.kind == DeviceKind::hid_controller ? kHidFrames : kSerialFrames;
  if (rate < min)
    add(fmt::format("{:.0f} frames a second arrive, of {:.0f}", rate, min / 0.9),
        "plug it into the machine itself, not into a hub, and flash the firmware of this version");
  if (c.lost * 1000 > c.frames)
    add(fmt::format("{} frames of {} were lost", c.lost, c.frames + c.lost),
        "use another cable, and a port that no disk or camera shares");
  if (c.bad > 0)
    add(fmt::format("{} received pieces are not frames", c.bad),
        "use a shorter cable, away from motors and mains; check that the firmware is ours");
  if (c.line_errors > 0)
    add(fmt::format("{} errors on the lines between sensors and controller", c.line_errors),
        "shorten the sensors' wires, twist clock and data with ground, check the pull-ups");
  if (c.overflows > 0)
    add(fmt::format("{} reports of a sensor that overflowed", c.overflows),
        "set the sensors to a coarser resolution (docs/cabinet.md, How fast a hand may be)");
  if (c.impossible > 0)
    add(fmt::format("{} impossible motions of a rod", c.impossible),
        "check the distance of the sensor to its rod, and shade it");
  for (std::size_t rod = 0; rod < c.index_disagreements.size(); ++rod) {
    if (c.index_disagreements[rod] == 0) continue;
    add(fmt::format(
            "the index mark of rod {} disagrees: it passed {} times more than a quarter turn "
            "from where the counts have it",
            rod + 1, c.index_disagreements[rod]),
        "check that its magnet, collar and switch are firm, and calibrate that rod again");
  }
  if (mean_latency_us(c) > kLatencyUs)
    add(fmt::format("frames wait {:.1f} ms until they are read", mean_latency_us(c) * 1e-3),
        kBusyCure);
}

void judge_rods(const FoundDevice& device, std::vector<Trouble>& troubles) {
  std::string silent;
  for (std::size_t rod = 0; rod < device.rods.size(); ++rod) {
    const RodCheck& check = device.rods[rod];
    if (check.status != RodStatus::live) {
      silent += (silent.empty() ? "" : ", ") + std::to_string(rod + 1);
      continue;
    }
    if (check.slide_range <= kNoiseSlide && check.angle_range <= kNoiseAngle) continue;
    troubles.push_back({device.path,
                        fmt::format("rod {} moved {:.1f} mm and {:.0f} degrees while it listened",
                                    rod + 1, 1e3 * check.slide_range, kDegrees * check.angle_range),
                        "leave the rods alone and try again; if nobody touched it, clean the "
                        "sensor, check its distance to the rod, and shade it"});
  }
  if (!silent.empty())
    troubles.push_back({device.path, "no sensor answers for rod " + silent,
                        "check the plug, the supply and the clock and data wires of that sensor"});
}

void judge_mouse(const FoundDevice& device, std::vector<Trouble>& troubles) {
  const RodCheck& check = device.rods[0];
  const bool moved = check.slide_range > kNoiseSlide || check.angle_range > kNoiseAngle;
  const bool by_hand = check.slide_range > kHandSlide || check.angle_range > kHandAngle;
  if (moved && !by_hand)
    troubles.push_back({device.path,
                        fmt::format("a rod of this mouse moved {:.1f} mm and {:.0f} degrees while "
                                    "it listened",
                                    1e3 * check.slide_range, kDegrees * check.angle_range),
                        "leave it alone and try again; if nobody touched it, clean its sensor and "
                        "put it on a matt surface"});
  if (by_hand && device.reports_per_s > 0 && device.reports_per_s < kMouseReports)
    troubles.push_back({device.path,
                        fmt::format("{:.0f} reports a second arrive while it moves, of 125 or more",
                                    device.reports_per_s),
                        "use a mouse with a cable, or bring its receiver nearer, plugged into the "
                        "machine itself"});
}

void judge_gamepad(const FoundDevice& device, std::vector<Trouble>& troubles) {
  const bool by_hand = device.stick_peak > kHandStick;
  const double off = by_hand ? device.stick_rest : device.stick_peak;
  if (off > double{kStickDeadZone})
    troubles.push_back(
        {device.path,
         fmt::format("a stick was {:.0f} % off its centre while it listened", 100 * off),
         fmt::format("let go of it and try again; if nobody touched it, it is worn or needs "
                     "calibration: {:.0f} % are ignored",
                     100 * double{kStickDeadZone})});
}

// For a mouse and a gamepad.
void judge_reports(const FoundDevice& device, std::vector<Trouble>& troubles) {
  const SourceCounters& c = device.counters;
  if (c.lost > 0)
    troubles.push_back(
        {device.path, fmt::format("the kernel dropped its reports {} times", c.lost), kBusyCure});
  if (mean_latency_us(c) > kLatencyUs)
    troubles.push_back(
        {device.path,
         fmt::format("reports wait {:.1f} ms until they are read", mean_latency_us(c) * 1e-3),
         kBusyCure});
}

void judge_input(const FoundDevice& device, std::vector<Trouble>& troubles) {
  if (device.state != DeviceState::live) {
    troubles.push_back({device.path, fmt::format("{} disappeared", text_of(device.kind).named),
                        "plug it in again; if it happens by itself, change the cable"});
    return;
  }
  judge_reports(device, troubles);
  if (device.kind == DeviceKind::mouse) judge_mouse(device, troubles);
  if (device.kind == DeviceKind::gamepad) judge_gamepad(device, troubles);
}

void judge_controller(const FoundDevice& device, bool another_is_live,
                      std::vector<Trouble>& troubles) {
  const bool serial = device.kind == DeviceKind::serial_controller;
  const bool is_it = !serial || device.named;  // not another device behind such a bridge
  switch (device.state) {
    case DeviceState::live:
      judge_frames(device, troubles);
      judge_rods(device, troubles);
      return;
    case DeviceState::missing:
    case DeviceState::refused:
      if (!is_it && another_is_live && device.counters.frames == 0) return;
      troubles.push_back({device.path,
                          device.counters.frames > 0 ? "the controller disappeared"
                                                     : "it disconnected before it sent a frame",
                          "plug it in again; if it happens by itself, change the cable"});
      return;
    default:
      break;
  }
  if (!is_it && another_is_live) return;
  const bool silent = device.state == DeviceState::silent;
  troubles.push_back(
      {device.path, silent ? "it is connected but sends nothing" : "it sends no valid frames",
       serial ? "flash our firmware, if it is the controller; ignore this for any other device"
              : "plug it in again, and flash the firmware of this version"});
}

void judge_calibration(const CalibrationCheck& check, std::vector<Trouble>& troubles) {
  if (!check.error.empty()) {
    troubles.push_back({check.path, check.error, "give another file, or calibrate again"});
  } else if (check.days > kOldDays) {
    troubles.push_back({check.path, fmt::format("the calibration is {:.0f} days old", check.days),
                        "calibrate again: rods and sensors shift with time"});
  } else if (check.days < -1) {
    troubles.push_back({check.path, "the calibration's date is in the future",
                        "set this machine's clock, or calibrate again"});
  }
}

// Each device that is certainly a controller has its own file or the given one.
void judge_calibrations(const Diagnosis& diagnosis, std::vector<Trouble>& troubles) {
  for (const CalibrationCheck& check : diagnosis.calibrations) judge_calibration(check, troubles);
  for (const FoundDevice& device : diagnosis.devices) {
    if (!is_controller(device) || !device.listens) continue;
    if (!device.calibration_conflict.empty())
      troubles.push_back({device.path, device.calibration_conflict,
                          "run space-foosball calibrate --device " + address_of(device) +
                              ", or give its own file with --calibration"});
    if (device.state == DeviceState::live && !device.calibrated)
      troubles.push_back(
          {device.path,
           "there is no calibration, so every rod has the error of its sensor's mounting",
           "run space-foosball calibrate --device " + address_of(device) +
               ", or give a file with --calibration"});
  }
}

void judge_none(const Diagnosis& diagnosis, std::vector<Trouble>& troubles) {
  if (std::ranges::any_of(diagnosis.devices, &FoundDevice::listens)) return;
  const bool lines = !diagnosis.devices.empty();
  troubles.push_back(
      {"", "no controller, mouse or gamepad is connected",
       std::string("plug one in; in a container pass /dev/input, /dev/hidraw* and "
                   "/sys in") +
           (lines ? "; if one of the ports above is a controller, give it with --device" : "")});
}

}  // namespace

std::vector<Trouble> troubles_of(const Diagnosis& diagnosis) {
  std::vector<Trouble> troubles;
  const bool live = std::ranges::any_of(diagnosis.devices, [](const FoundDevice& device) {
    return is_controller(device) && device.state == DeviceState::live;
  });
  for (const FoundDevice& device : diagnosis.devices) {
    if (!device.listens) continue;
    if (device.error != 0) {
      troubles.push_back(not_readable(device));
    } else if (is_controller(device)) {
      judge_controller(device, live, troubles);
    } else {
      judge_input(device, troubles);
    }
  }
  judge_none(diagnosis, troubles);
  judge_calibrations(diagnosis, troubles);
  return troubles;
}

}  // namespace cabinet
