#pragma once

#include <numbers>
#include <string>
#include <vector>

#include "cabinet/doctor.h"

namespace cabinet {

inline constexpr double kDegrees = 180 / std::numbers::pi;  // per radian

// Finds controllers, mice and gamepads below options.dev, described by options.sys, sorted by path;
// then those of options.devices that are not among them.
std::vector<FoundDevice> find_devices(const DoctorOptions& options);

inline bool is_controller(const FoundDevice& device) {
  return device.kind == DeviceKind::hid_controller || device.kind == DeviceKind::serial_controller;
}
// The address in the format of --device; for a gamepad its path.
std::string address_of(const FoundDevice& device);
double mean_latency_us(const SourceCounters& counters);
double frames_per_s(const FoundDevice& device);

}  // namespace cabinet
