#include "cabinet/doctor.h"

#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <numbers>
#include <utility>

#include "arrival_watch.h"
#include "cabinet/controller.h"
#include "cabinet/device_source.h"
#include "doctor_find.h"
#include "exclusive_line.h"
#include "os/clock.h"

namespace cabinet {
namespace {

constexpr double kStartSeconds = 3;  // of an Arduino's boot loader, and ours
// A rod that nobody touches moves less: sensors' noise is a count or two, 0.9 degrees each.
constexpr double kNoiseSlide = 0.5e-3, kNoiseAngle = 3 * std::numbers::pi / 180;
constexpr double kHidFrames = 900, kSerialFrames = 225;  // a second; 1000 and 250 are sent
constexpr double kLatencyUs = 1'500;                     // a poll each 1 ms leaves 0.5
constexpr double kOldDays = 180;  // sensors and rods are moved in half a year
constexpr double kDegrees = 180 / std::numbers::pi;

bool is_controller(const FoundDevice& device) {
  return device.kind == DeviceKind::hid_controller || device.kind == DeviceKind::serial_controller;
}

std::function<std::int64_t()> each_millisecond() {
  return [due = os::monotonic_ns()]() mutable {
    due = std::max(due + 1'000'000, os::monotonic_ns());
    os::sleep_until_ns(due);
    return os::monotonic_us();
  };
}

class RangesOfRods {
 public:
  void add(const RodInputs& rods) {
    for (std::size_t i = 0; i < rods.size(); ++i) {
      Range& range = ranges_[i];
      const double slide = rods[i].slide - rods[i].slide_ahead;
      const double angle = rods[i].angle - rods[i].angle_ahead;
      range = {std::min(range.slide_least, slide), std::max(range.slide_most, slide),
               std::min(range.angle_least, angle), std::max(range.angle_most, angle)};
    }
  }
  RodCheck check(std::size_t rod, RodStatus status) const {
    const Range& range = ranges_[rod];
    return {status, range.slide_most - range.slide_least, range.angle_most - range.angle_least};
  }

 private:
  struct Range {
    double slide_least = 0, slide_most = 0, angle_least = 0, angle_most = 0;
  };
  std::array<Range, kRods> ranges_;
};

void listen(FoundDevice& device, const Calibration& calibration, const DoctorOptions& options) {
  ArrivalWatch arrivals;
  DeviceOptions with;
  with.name = device.path;
  with.framing =
      device.kind == DeviceKind::hid_controller ? DeviceFraming::report : DeviceFraming::cobs;
  with.calibration = calibration;
  with.opener_sets_line = true;
  with.arrived_us = [&arrivals] { return arrivals.last_us(); };
  DeviceSource source(std::move(with), [&device, &arrivals] {
    const int fd = open_exclusively(device.path.c_str());
    if (fd >= 0) arrivals.watch(fd);
    return fd;
  });
  const auto next_poll = options.next_poll ? options.next_poll : each_millisecond();
  const std::int64_t began = next_poll();
  std::int64_t first = -1, now = began;
  RangesOfRods ranges;
  const auto seconds = [](std::int64_t us) { return 1e-6 * static_cast<double>(us); };
  while (seconds(now - (first >= 0 ? first : began)) <
         options.seconds + (first >= 0 ? 0 : kStartSeconds)) {
    now = next_poll();
    source.poll(now);
    if (source.state() == DeviceState::refused) break;
    if (first < 0 && source.counters().frames > 0) first = now;
    ranges.add(source.rods());
  }
  device.state = source.state();
  device.error = device.state == DeviceState::refused ? source.open_error() : 0;
  device.seconds = first >= 0 ? seconds(now - first) : 0;
  device.counters = source.counters();
  for (std::size_t rod = 0; rod < device.rods.size(); ++rod) {
    device.rods[rod] = ranges.check(rod, source.rods()[rod].status);
  }
}

std::string of_error(int error) {
  return std::strerror(error);
}

Trouble not_readable(const FoundDevice& device) {
  const char* what = is_controller(device)                ? "the controller"
                     : device.kind == DeviceKind::gamepad ? "the gamepad"
                                                          : "the mouse";
  const std::string sentence = fmt::format("{} may not be read: {}", what, of_error(device.error));
  switch (device.error) {
    case EACCES:
    case EPERM:
      if (device.kind == DeviceKind::serial_controller)
        return {device.path, sentence,
                "join the group of the line (sudo usermod -aG dialout $USER) and log in anew"};
      return {device.path, sentence,
              "install cabinet/70-space-foosball.rules and plug it in again, or join group input "
              "and log in anew"};
    case EBUSY:
      return {device.path, fmt::format("{} is in use", what),
              "end the server, or the other program, that has it"};
    case ENOENT:
      return {device.path, fmt::format("{} is known to the kernel but has no node", what),
              "start udev; in a container pass the device in"};
    default:
      return {device.path, sentence, "plug it in anew, into another socket or with another cable"};
  }
}

void judge_frames(const FoundDevice& device, std::vector<Trouble>& troubles) {
  const auto add = [&](std::string what, std::string cure) {
    troubles.push_back({device.path, std::move(what), std::move(cure)});
  };
  const SourceCounters& c = device.counters;
  const double rate = static_cast<double>(c.frames) / std::max(device.seconds, 1e-3);
  const double least = device.kind == DeviceKind::hid_controller ? kHidFrames : kSerialFrames;
  if (rate < least)
    add(fmt::format("{:.0f} frames a second come, of {:.0f}", rate, least / 0.9),
        "plug it into the machine itself, not into a hub, and flash the firmware of this version");
  if (c.lost * 1000 > c.frames)
    add(fmt::format("{} frames of {} were lost", c.lost, c.frames + c.lost),
        "take another cable, and another socket than a disk's or a camera's");
  if (c.bad > 0)
    add(fmt::format("{} pieces of what came are no frames", c.bad),
        "take a shorter cable, away from motors and mains; check that the firmware is ours");
  if (c.line_errors > 0)
    add(fmt::format("{} errors on the lines between sensors and controller", c.line_errors),
        "shorten the sensors' wires, twist clock and data with ground, check the pull-ups");
  if (c.overflows > 0)
    add(fmt::format("{} reports of a sensor that overflowed", c.overflows),
        "set the sensors to a coarser resolution (docs/cabinet.md, How fast a hand may be)");
  if (c.impossible > 0)
    add(fmt::format("{} motions came that no rod can make", c.impossible),
        "check the distance of the sensor to its rod, and shade it");
  for (std::size_t rod = 0; rod < c.index_disagreements.size(); ++rod) {
    if (c.index_disagreements[rod] == 0) continue;
    add(fmt::format(
            "the index mark of rod {} disagrees: it passed {} times more than a quarter turn "
            "from where the counts have it",
            rod + 1, c.index_disagreements[rod]),
        "see that its magnet, collar and switch sit firmly, and calibrate that rod again");
  }
  const double latency =
      c.stamped > 0 ? static_cast<double>(c.latency_sum_us) / static_cast<double>(c.stamped) : 0;
  if (latency > kLatencyUs)
    add(fmt::format("frames wait {:.1f} ms until they are read", latency * 1e-3),
        "end what keeps the machine busy; the server asks for real-time priority (CAP_SYS_NICE)");
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

void judge(const FoundDevice& device, bool another_is_live, std::vector<Trouble>& troubles) {
  if (device.error != 0) {
    troubles.push_back(not_readable(device));
    return;
  }
  if (!is_controller(device)) return;
  const bool serial = device.kind == DeviceKind::serial_controller;
  switch (device.state) {
    case DeviceState::live:
      judge_frames(device, troubles);
      judge_rods(device, troubles);
      return;
    case DeviceState::missing:
    case DeviceState::refused:
      troubles.push_back({device.path, "the controller went away",
                          "plug it in again; if it happens by itself, change the cable"});
      return;
    default:
      break;
  }
  if (serial && another_is_live) return;  // some other device
  const bool silent = device.state == DeviceState::silent;
  troubles.push_back(
      {device.path, silent ? "it is there but sends nothing" : "it sends what is no frame",
       serial ? "flash our firmware, if it is the controller; any other device may stay as it is"
              : "plug it in anew, and flash the firmware of this version"});
}

std::string address_of(const FoundDevice& device) {
  return (device.kind == DeviceKind::hid_controller ? "hid:" : "serial:") + device.path;
}

// The one that was named, else the one that is kept for a controller that is here; or empty.
std::string calibration_to_judge(const DoctorOptions& options,
                                 const std::vector<FoundDevice>& devices) {
  if (!options.calibration.empty() || options.calibrations.empty()) return options.calibration;
  for (const FoundDevice& device : devices) {
    if (!is_controller(device)) continue;
    const std::string serial = controller_serial(address_of(device), options.sys);
    std::string path = calibration_file(options.calibrations, serial);
    if (::access(path.c_str(), F_OK) == 0) return path;
  }
  return {};
}

CalibrationCheck check_calibration(const DoctorOptions& options, const std::string& path,
                                   Calibration& into) {
  CalibrationCheck check;
  check.path = path;
  auto loaded = load_calibration(path);
  if (!loaded) {
    check.error = loaded.error();
    return check;
  }
  into = *loaded;
  struct stat about {};
  if (::stat(path.c_str(), &about) == 0) {
    check.days = static_cast<double>(options.now_s - about.st_mtime) / 86'400;
  }
  return check;
}

void judge_calibration(const Diagnosis& diagnosis, std::vector<Trouble>& troubles) {
  const auto controller = std::ranges::find_if(diagnosis.devices, is_controller);
  if (!diagnosis.calibration) {
    if (controller != diagnosis.devices.end())
      troubles.push_back(
          {"", "there is no calibration, so that every rod is off by its sensor's mounting",
           "run space-foosball calibrate --device " + address_of(*controller) +
               ", or name a file by --calibration"});
    return;
  }
  const CalibrationCheck& check = *diagnosis.calibration;
  if (!check.error.empty()) {
    troubles.push_back({check.path, check.error, "name another file, or calibrate anew"});
  } else if (check.days > kOldDays) {
    troubles.push_back({check.path, fmt::format("the calibration is {:.0f} days old", check.days),
                        "calibrate anew: rods and sensors do not stay where they were"});
  }
}

}  // namespace

Diagnosis examine(const DoctorOptions& options) {
  Diagnosis diagnosis;
  Calibration calibration = nominal_calibration();
  diagnosis.devices = find_devices(options.dev, options.sys);
  const std::string path = calibration_to_judge(options, diagnosis.devices);
  if (!path.empty()) diagnosis.calibration = check_calibration(options, path, calibration);
  for (FoundDevice& device : diagnosis.devices) {
    if (is_controller(device) && device.error == 0) listen(device, calibration, options);
  }
  const bool live = std::ranges::any_of(diagnosis.devices, [](const FoundDevice& device) {
    return is_controller(device) && device.state == DeviceState::live;
  });
  for (const FoundDevice& device : diagnosis.devices) judge(device, live, diagnosis.troubles);
  if (diagnosis.devices.empty())
    diagnosis.troubles.push_back({"", "no controller, mouse or gamepad is connected",
                                  "plug one in; in a container pass /dev/input, /dev/hidraw* and "
                                  "/sys in"});
  judge_calibration(diagnosis, diagnosis.troubles);
  return diagnosis;
}

}  // namespace cabinet
