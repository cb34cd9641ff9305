#include <fmt/format.h>

#include <nlohmann/json.hpp>
#include <numbers>

#include "cabinet/doctor.h"

namespace cabinet {
namespace {

constexpr double kDegrees = 180 / std::numbers::pi;

const char* name_of(DeviceKind kind) {
  switch (kind) {
    case DeviceKind::hid_controller:
      return "hid";
    case DeviceKind::serial_controller:
      return "serial";
    case DeviceKind::mouse:
      return "mouse";
    case DeviceKind::gamepad:
      return "gamepad";
  }
  return "";
}

const char* name_of(DeviceState state) {
  switch (state) {
    case DeviceState::missing:
      return "missing";
    case DeviceState::refused:
      return "refused";
    case DeviceState::silent:
      return "silent";
    case DeviceState::garbled:
      return "garbled";
    case DeviceState::live:
      return "live";
    case DeviceState::over:
      return "over";
  }
  return "";
}

const char* name_of(RodStatus status) {
  switch (status) {
    case RodStatus::absent:
      return "absent";
    case RodStatus::live:
      return "live";
    case RodStatus::held:
      return "held";
  }
  return "";
}

double rate(const FoundDevice& device) {
  return device.seconds > 0 ? static_cast<double>(device.counters.frames) / device.seconds : 0;
}

double mean_latency_us(const SourceCounters& c) {
  return c.stamped > 0 ? static_cast<double>(c.latency_sum_us) / static_cast<double>(c.stamped) : 0;
}

bool is_controller(const FoundDevice& device) {
  return device.kind == DeviceKind::hid_controller || device.kind == DeviceKind::serial_controller;
}

// A device's own name is a stranger's: no control characters reach a terminal.
std::string printable(const std::string& text) {
  std::string clean;
  for (const char c : text) clean += static_cast<unsigned char>(c) < 0x20 || c == 0x7F ? '?' : c;
  return clean;
}

std::string address_of(const FoundDevice& device) {
  if (device.kind == DeviceKind::gamepad) return device.path;
  const char* scheme = device.kind == DeviceKind::mouse ? "evdev" : name_of(device.kind);
  return fmt::format("{}:{}", scheme, device.path);
}

std::string line_of(const FoundDevice& device) {
  std::string text = fmt::format("{:<8} {}  {}\n", name_of(device.kind), address_of(device),
                                 printable(device.name));
  if (!is_controller(device) || device.seconds == 0) return text;
  const SourceCounters& c = device.counters;
  text += fmt::format(
      "         {:.0f} frames a second, {} lost, {} no frames, {} errors on the sensors' lines\n"
      "         from arrival to tick {:.0f} us, at most {}\n",
      rate(device), c.lost, c.bad, c.line_errors, mean_latency_us(c), c.latency_max_us);
  for (std::size_t rod = 0; rod < device.rods.size(); ++rod) {
    const RodCheck& check = device.rods[rod];
    text +=
        fmt::format("         rod {}: {}, at rest within {:.2f} mm and {:.1f} degrees\n", rod + 1,
                    name_of(check.status), 1e3 * check.slide_range, kDegrees * check.angle_range);
  }
  return text;
}

nlohmann::json json_of(const FoundDevice& device) {
  nlohmann::json out = {{"kind", name_of(device.kind)},
                        {"path", device.path},
                        {"address", address_of(device)},
                        {"name", device.name},
                        {"readable", device.error == 0}};
  if (!is_controller(device)) return out;
  const SourceCounters& c = device.counters;
  out["state"] = name_of(device.state);
  out["frames_per_s"] = rate(device);
  out["frames"] = c.frames;
  out["lost"] = c.lost;
  out["bad"] = c.bad;
  out["line_errors"] = c.line_errors;
  out["overflows"] = c.overflows;
  out["impossible"] = c.impossible;
  out["latency_mean_us"] = mean_latency_us(c);
  out["latency_max_us"] = c.latency_max_us;
  out["rods"] = nlohmann::json::array();
  for (std::size_t i = 0; i < device.rods.size(); ++i) {
    const RodCheck& rod = device.rods[i];
    out["rods"].push_back({{"status", name_of(rod.status)},
                           {"rest_slide_m", rod.slide_range},
                           {"rest_angle_rad", rod.angle_range},
                           {"index_disagreements", c.index_disagreements[i]}});
  }
  return out;
}

}  // namespace

std::string diagnosis_text(const Diagnosis& diagnosis) {
  std::string text;
  for (const FoundDevice& device : diagnosis.devices) text += line_of(device);
  if (diagnosis.calibration && diagnosis.calibration->error.empty()) {
    text += fmt::format("calibration {}, {:.0f} days old\n", diagnosis.calibration->path,
                        diagnosis.calibration->days);
  }
  for (const Trouble& trouble : diagnosis.troubles) {
    text += fmt::format("\ntrouble: {}{}{}.\n  do: {}.\n", trouble.device,
                        trouble.device.empty() ? "" : ": ", trouble.what, trouble.cure);
  }
  if (diagnosis.troubles.empty()) text += "\nall is well.\n";
  return text;
}

std::string diagnosis_json(const Diagnosis& diagnosis) {
  nlohmann::json out = {{"healthy", diagnosis.troubles.empty()},
                        {"devices", nlohmann::json::array()},
                        {"troubles", nlohmann::json::array()}};
  for (const FoundDevice& device : diagnosis.devices) out["devices"].push_back(json_of(device));
  if (diagnosis.calibration) {
    const CalibrationCheck& check = *diagnosis.calibration;
    out["calibration"] = {
        {"path", check.path}, {"valid", check.error.empty()}, {"days", check.days}};
  }
  for (const Trouble& trouble : diagnosis.troubles) {
    out["troubles"].push_back(
        {{"device", trouble.device}, {"what", trouble.what}, {"cure", trouble.cure}});
  }
  // A name that is no UTF-8 is a device's fault, and no reason to say nothing.
  return out.dump(2, ' ', false, nlohmann::json::error_handler_t::replace) + "\n";
}

}  // namespace cabinet
