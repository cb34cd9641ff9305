#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "cabinet/doctor.h"
#include "doctor_find.h"
#include "printable.h"

namespace cabinet {
namespace {

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

std::string lines_of_controller(const FoundDevice& device) {
  const SourceCounters& c = device.counters;
  std::string text = fmt::format(
      "         {:.0f} frames a second, {} lost, {} not frames, {} errors on the sensors' lines\n"
      "         from arrival to tick {:.0f} us, at most {}\n",
      frames_per_s(device), c.lost, c.bad, c.line_errors, mean_latency_us(c), c.latency_max_us);
  for (std::size_t rod = 0; rod < device.rods.size(); ++rod) {
    const RodCheck& check = device.rods[rod];
    text +=
        fmt::format("         rod {}: {}, at rest within {:.2f} mm and {:.1f} degrees\n", rod + 1,
                    name_of(check.status), 1e3 * check.slide_range, kDegrees * check.angle_range);
  }
  return text;
}

std::string lines_of_input(const FoundDevice& device) {
  const SourceCounters& c = device.counters;
  if (c.frames == 0)
    return "         nothing moved; move it during the measurement to see its rate and latency\n";
  std::string text = fmt::format(
      "         {} reports, {:.0f} a second, {} times lost\n"
      "         from the kernel to this program {:.0f} us, at most {}\n",
      c.frames, device.reports_per_s, c.lost, mean_latency_us(c), c.latency_max_us);
  if (device.kind == DeviceKind::mouse)
    text += fmt::format("         a rod of it moved {:.2f} mm and {:.1f} degrees\n",
                        1e3 * device.rods[0].slide_range, kDegrees * device.rods[0].angle_range);
  if (device.kind == DeviceKind::gamepad)
    text += fmt::format("         its sticks reached {:.0f} %, and rest within {:.0f} %\n",
                        100 * device.stick_peak, 100 * device.stick_rest);
  return text;
}

std::string lines_of(const FoundDevice& device) {
  std::string text = fmt::format("{:<8} {}{}{}\n", name_of(device.kind), address_of(device),
                                 device.name.empty() ? "" : "  ", printable(device.name));
  if (!device.listens)
    return text + "         not opened, since it may be any device; if it is a controller, add " +
           "--device " + address_of(device) + "\n";
  if (device.error != 0) return text;
  if (is_controller(device)) return device.seconds > 0 ? text + lines_of_controller(device) : text;
  return device.state == DeviceState::live ? text + lines_of_input(device) : text;
}

nlohmann::json json_of(const FoundDevice& device) {
  nlohmann::json out = {{"kind", name_of(device.kind)},  {"path", device.path},
                        {"address", address_of(device)}, {"name", device.name},
                        {"readable", device.error == 0}, {"opened", device.listens}};
  if (is_controller(device)) {
    out["usb_id"] = device.usb_id;
    out["serial"] = device.serial;
  }
  if (!device.listens) return out;
  const SourceCounters& c = device.counters;
  out["state"] = name_of(device.state);
  out["frames_per_s"] = is_controller(device) ? frames_per_s(device) : device.reports_per_s;
  out["frames"] = c.frames;
  out["lost"] = c.lost;
  out["latency_mean_us"] = mean_latency_us(c);
  out["latency_max_us"] = c.latency_max_us;
  if (device.kind == DeviceKind::gamepad) {
    out["stick_peak"] = device.stick_peak;
    out["stick_rest"] = device.stick_rest;
  }
  if (device.kind == DeviceKind::mouse) {
    out["rest_slide_m"] = device.rods[0].slide_range;
    out["rest_angle_rad"] = device.rods[0].angle_range;
  }
  if (!is_controller(device)) return out;
  out["bad"] = c.bad;
  out["line_errors"] = c.line_errors;
  out["overflows"] = c.overflows;
  out["impossible"] = c.impossible;
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
  for (const FoundDevice& device : diagnosis.devices) text += lines_of(device);
  for (const CalibrationCheck& check : diagnosis.calibrations) {
    if (!check.error.empty()) continue;
    text += fmt::format("calibration {}{}, {:.0f} days old\n",
                        check.device.empty() ? "" : "of " + check.device + ": ", check.path,
                        std::max(check.days, 0.0));
  }
  for (const Trouble& trouble : diagnosis.troubles) {
    text += fmt::format("\ntrouble: {}{}{}.\n  do: {}.\n", trouble.device,
                        trouble.device.empty() ? "" : ": ", trouble.what, trouble.cure);
  }
  if (diagnosis.troubles.empty()) text += "\nno fault found.\n";
  return text;
}

std::string diagnosis_json(const Diagnosis& diagnosis) {
  nlohmann::json out = {{"healthy", diagnosis.troubles.empty()},
                        {"devices", nlohmann::json::array()},
                        {"calibrations", nlohmann::json::array()},
                        {"troubles", nlohmann::json::array()}};
  for (const FoundDevice& device : diagnosis.devices) out["devices"].push_back(json_of(device));
  for (const CalibrationCheck& check : diagnosis.calibrations) {
    out["calibrations"].push_back({{"device", check.device},
                                   {"path", check.path},
                                   {"valid", check.error.empty()},
                                   {"days", check.days}});
  }
  for (const Trouble& trouble : diagnosis.troubles) {
    out["troubles"].push_back(
        {{"device", trouble.device}, {"what", trouble.what}, {"cure", trouble.cure}});
  }
  // A device name that is not UTF-8 must not prevent the output.
  return out.dump(2, ' ', false, nlohmann::json::error_handler_t::replace) + "\n";
}

}  // namespace cabinet
