#include "cabinet/controller.h"

#include <array>
#include <cstdio>
#include <filesystem>
#include <fstream>

#include "os/user_folder.h"
#include "printable.h"

namespace cabinet {
namespace {

namespace fs = std::filesystem;

// Walks up from the device node to its USB device. In between are the interface and, for hidraw,
// the HID device, or, for serial lines behind a bridge, their port. Hubs above it have serial
// numbers of their own.
constexpr int kMaxLevels = 6;
constexpr std::size_t kMaxUsbWord = 64;
const char* const kUnnumbered = "unnumbered";

std::string first_line(const fs::path& path) {
  std::ifstream file(path);
  std::string line;
  std::getline(file, line);
  if (line.size() > kMaxUsbWord) line.resize(kMaxUsbWord);
  return line;
}

bool is_plain(char c) {
  return (c >= '0' && c <= '9') || (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '-';
}

// The file name of earlier versions, in which two serial numbers could have the same name.
std::string older_file(const std::string& folder, const std::string& serial) {
  std::string name;
  for (const char c : serial) name += is_plain(c) ? c : '_';
  return folder + "/" + name + ".json";
}

bool exists(const std::string& path) {
  std::error_code unknown;
  return fs::exists(path, unknown);
}

}  // namespace

UsbIdentity usb_identity(const std::string& device_class, const std::string& node,
                         const std::string& sys) {
  std::error_code error;
  fs::path at = fs::canonical(fs::path(sys) / "class" / device_class / node / "device", error);
  if (error) return {};
  for (int level = 0; level < kMaxLevels && at.has_relative_path(); ++level) {
    if (fs::exists(at / "idVendor", error))
      return {first_line(at / "idVendor") + ":" + first_line(at / "idProduct"),
              first_line(at / "serial"), first_line(at / "product")};
    at = at.parent_path();
  }
  return {};
}

UsbIdentity usb_identity_at(const std::string& address, const std::string& sys) {
  const auto colon = address.find(':');
  if (colon == std::string::npos) return {};
  const std::string scheme = address.substr(0, colon);
  const char* kind = scheme == "serial" ? "tty" : scheme == "hid" ? "hidraw" : nullptr;
  if (kind == nullptr) return {};
  std::error_code error;
  // /dev/serial/by-id/... is a link to the device.
  const fs::path real = fs::weakly_canonical(address.substr(colon + 1), error);
  return usb_identity(kind, real.filename(), sys);
}

std::string controller_serial(const std::string& address, const std::string& sys) {
  return usb_identity_at(address, sys).serial;
}

std::string calibration_file(const std::string& folder, const std::string& serial) {
  std::string name;
  for (const char c : serial) {
    // So that no serial number maps to the name for controllers without one.
    if (is_plain(c) && !(name.empty() && serial == kUnnumbered)) {
      name += c;
      continue;
    }
    std::array<char, 4> code{};
    std::snprintf(code.data(), code.size(), "_%02X", static_cast<unsigned char>(c));
    name += code.data();
  }
  return folder + "/" + (name.empty() ? kUnnumbered : name) + ".json";
}

std::string kept_calibration(const std::string& folder, const std::string& serial) {
  if (folder.empty()) return {};
  std::string file = calibration_file(folder, serial);
  if (exists(file)) return file;
  std::string older = older_file(folder, serial);
  if (serial.empty() || !exists(older)) return {};
  // The file may belong to another controller that had the same name.
  const auto calibration = load_calibration(older);
  return calibration && !serial_conflict(*calibration, serial).empty() ? "" : older;
}

std::string serial_conflict(const Calibration& calibration, const std::string& serial) {
  if (calibration.serial.empty() || serial.empty() || calibration.serial == serial) return {};
  return "the calibration is of the controller with serial number " +
         printable(calibration.serial) + ", and this one has " + printable(serial);
}

std::string calibrations_folder() {
  const std::string data = os::data_folder();
  return data.empty() ? "" : data + "/space-foosball/calibrations";
}

}  // namespace cabinet
